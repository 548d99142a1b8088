// SPDX-License-Identifier: Apache-2.0
// Which coefficients make match_sigma_px agree best with the real errors? They are fitted to
// Middlebury's cones and cloth3 and to four scenes of the simulated ZED at one and two times its
// noise. matcher_sigma tests them on other images.
// Usage: sigma_fit STEREO_DATA_DIR OUT_DIR [FIRST_SEED [SEEDS]]
//   FIRST_SEED: default 21. SEEDS: number of seeds, default 4.
//
// Writes OUT_DIR/sigma_fit.csv: image,set,within_1,within_2,within_3: share of the trusted matches
// within 1, 2 and 3 sigma [%], of those that are right within 1 px. Sets: "as it comes" (the
// library's coefficients) and "fitted". The fitted coefficients are printed to stdout.
#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "lab/stereo_pairs/match_evidence.hpp"
#include "lab/stereo_pairs/rival_matchers.hpp"
#include "lab/stereo_pairs/stereo_pairs.hpp"
#include "service/console/log.hpp"
#include "surefoot/stereo/confidence.hpp"

namespace surefoot::experiments {
namespace {

/// Uses only every n-th match, because neighbouring pixels have correlated errors.
constexpr int kTakenEvery = 13;
/// Weight of a real pair; a simulated image weighs 1. Both real pairs together weigh half as much
/// as all 32 images.
constexpr double kWeightOfRealPair = 8.0;
/// Degrees of freedom of Student's t. Its likelihood tolerates the few large outliers.
constexpr double kFreedom = 8.0;
/// Wanted shares within 1 and 2 sigma of every image [%]. Deviations of kMiss [%] from the two
/// shares cost the same loss.
constexpr double kWanted[] = {68.3, 95.0};
constexpr double kMiss[] = {5.0, 3.0};
constexpr double kMissWeight = 0.03;

/// Coefficients of match_sigma_px, in this order: floor, gain, share of the shift, jump, hole.
using Coefficients = std::array<double, 5>;
constexpr Coefficients kNow = {static_cast<double>(stereo::kSigmaFloor_px),
                               static_cast<double>(stereo::kSigmaGain),
                               static_cast<double>(stereo::kSigmaShiftShare),
                               static_cast<double>(stereo::kSigmaJump_px),
                               static_cast<double>(stereo::kSigmaHole_px)};

/// The coefficient that is not fitted: the share of the shift. The loss hardly depends on it. But
/// the value of smallest loss, 0.8, gives a worse order of the uncertainties under an ideal camera
/// than this value (sparsification, matcher_sigma from seed 21 on).
constexpr std::size_t kHeld = 2;
constexpr double kHeldShare = 0.45;

/// Factors of the squared coefficients, and the real error of the match.
struct Sample {
    std::array<double, 5> terms{};
    double error_px = 0.0;
};

struct Seen {
    std::string name;
    double truth_variance_px2 = 0.0;
    double weight = 1.0;
    std::vector<Sample> samples;
};

/// Computes the formula of match_sigma_px with any coefficients.
double variance_px2(const Sample& sample, const Coefficients& c) {
    constexpr auto kMost_px = static_cast<double>(stereo::kMaxSigma_px);
    double sum = 0.0;
    for (std::size_t k = 0; k < c.size(); ++k) sum += c[k] * c[k] * sample.terms[k];
    return std::fmin(kMost_px * kMost_px, sum);
}

/// `see` checks these terms against match_sigma_px.
std::array<double, 5> terms_of(const stereo::MatchEvidence& evidence) {
    const auto square = [](double x) { return x * x; };
    const double noise_px =
        evidence.gradient_grey_px * stereo::kMaxNoisePerPixel_px > evidence.residual_grey
            ? static_cast<double>(evidence.residual_grey / evidence.gradient_grey_px)
            : static_cast<double>(stereo::kMaxNoisePerPixel_px);
    const double near = std::fmax(
        0.0, 1.0 - evidence.jump_distance_px / static_cast<double>(stereo::kJumpReach_px));
    return {1.0,
            square(noise_px),
            square(static_cast<double>(evidence.shift_px)),
            square(near),
            square(static_cast<double>(evidence.unknown_share))};
}

/// Collects trusted matches that are right within 1 px. Returns an error if the formula above
/// differs from match_sigma_px.
Result<Seen> see(const TruePair& pair) {
    const PairEvidence evidence(pair);
    Seen seen{pair.name, pair.step_px * pair.step_px / 12.0, 1.0, {}};
    int count = 0;
    for (int v = 0; v < pair.truth_px.height(); ++v) {
        for (int u = 0; u < pair.truth_px.width(); ++u) {
            const float error_px = evidence.disparity_px.at(u, v) - pair.truth_px.at(u, v);
            if (!(std::abs(error_px) <= 1.0F)) continue;
            const stereo::MatchEvidence match = evidence.at(u, v);
            if (stereo::outlier_probability(match) > kTrustedOutlierProbability ||
                ++count % kTakenEvery != 0)
                continue;
            seen.samples.push_back({terms_of(match), static_cast<double>(error_px)});
            const double sigma_px = std::sqrt(variance_px2(seen.samples.back(), kNow));
            if (std::abs(sigma_px - static_cast<double>(stereo::match_sigma_px(match))) > 1e-5)
                return input_error(
                    "match_sigma_px has changed; update variance_px2 in lab/sigma_fit/main.cpp");
        }
    }
    return seen;
}

/// Returns the shares of the matches within one, two and three sigma [%].
std::array<double, 3> cover(const Seen& seen, const Coefficients& c) {
    std::array<double, 3> within{};
    for (const Sample& sample : seen.samples) {
        const double variance = variance_px2(sample, c) + seen.truth_variance_px2;
        const double share = sample.error_px * sample.error_px / variance;
        for (std::size_t k = 0; k < within.size(); ++k) {
            const auto limit = static_cast<double>(k + 1);
            if (share <= limit * limit) within[k] += 100.0;
        }
    }
    for (double& w : within) w /= static_cast<double>(seen.samples.size());
    return within;
}

/// Returns the mean negative log-likelihood of a match, up to a constant.
double surprise(const Seen& seen, const Coefficients& c) {
    double sum = 0.0;
    for (const Sample& sample : seen.samples) {
        const double variance = variance_px2(sample, c) + seen.truth_variance_px2;
        const double share = sample.error_px * sample.error_px / variance;
        sum += 0.5 * std::log(variance) + 0.5 * (kFreedom + 1.0) * std::log1p(share / kFreedom);
    }
    return sum / static_cast<double>(seen.samples.size());
}

/// Returns the sum of two terms. The likelihood rewards larger sigmas for matches with larger
/// errors. The deviations from kWanted prevent a gain for one kind of image at the expense of
/// another.
double loss(const std::vector<Seen>& all, const Coefficients& c) {
    double sum = 0.0;
    double weights = 0.0;
    for (const Seen& seen : all) {
        const std::array<double, 3> within = cover(seen, c);
        double missed = 0.0;
        for (std::size_t k = 0; k < std::size(kWanted); ++k)
            missed += std::pow((within[k] - kWanted[k]) / kMiss[k], 2);
        sum += seen.weight * (surprise(seen, c) + kMissWeight * missed);
        weights += seen.weight;
    }
    return sum / weights;
}

/// Fits by coordinate descent: changes one coefficient after the other, then all together, with
/// decreasing steps.
Coefficients fitted(const std::vector<Seen>& all) {
    Coefficients best = kNow;
    best[kHeld] = kHeldShare;
    double least = loss(all, best);
    for (double step = 0.2; step > 0.004;) {
        bool better = false;
        for (std::size_t k = 0; k <= best.size(); ++k) {
            for (const double factor : {1.0 + step, 1.0 / (1.0 + step)}) {
                Coefficients tried = best;
                for (std::size_t i = 0; i < tried.size(); ++i)
                    if (i != kHeld && (i == k || k == best.size())) tried[i] *= factor;
                const double found = loss(all, tried);
                if (found >= least) continue;
                best = tried;
                least = found;
                better = true;
            }
        }
        if (!better) step /= 2.0;
    }
    return best;
}

/// Scales the coefficients until the wanted share of matches lies within one sigma on average.
Coefficients scaled(const std::vector<Seen>& all, const Coefficients& c) {
    const auto times = [&](double factor) {
        Coefficients changed = c;
        for (double& value : changed) value *= factor;
        return changed;
    };
    double low = 0.5;
    double high = 2.0;
    while (high - low > 1e-3) {
        const double middle = 0.5 * (low + high);
        double sum = 0.0;
        double weights = 0.0;
        for (const Seen& seen : all) {
            sum += seen.weight * cover(seen, times(middle))[0];
            weights += seen.weight;
        }
        (sum / weights < kWanted[0] ? low : high) = middle;
    }
    return times(high);
}

Result<std::vector<Seen>> see_all(const std::string& data,
                                  std::uint64_t first_seed,
                                  std::uint64_t seeds) {
    const auto pairs = middlebury_pairs(data);
    if (!pairs) return pairs.error();
    std::vector<Seen> all;
    const auto add = [&](const TruePair& pair, double weight, const std::string& name) -> Status {
        auto seen = see(pair);
        if (!seen) return seen.error();
        seen->weight = weight;
        seen->name = name;
        all.push_back(std::move(*seen));
        return {};
    };
    for (const TruePair& pair : *pairs) {
        if (pair.name != "cones" && pair.name != "cloth3") continue;
        if (auto added = add(pair, kWeightOfRealPair, pair.name); !added) return added.error();
    }
    sim::SceneOptions options;
    options.profile = sim::CameraProfile::zed;
    for (const char* scene : {"demo_stairs", "sill_13", "kerb_down_150", "floor"}) {
        options.scene = scene;
        for (const double noise : {1.0, 2.0}) {
            options.noise = noise;
            for (std::uint64_t k = 0; k < seeds; ++k) {
                options.seed = first_seed + k;
                const auto pair = simulated_pair(options);
                if (!pair) return pair.error();
                const std::string name = fmt::format("{}; seed {}", pair->name, options.seed);
                if (auto added = add(*pair, 1.0, name); !added) return added.error();
            }
        }
    }
    return all;
}

Status run(const std::string& data,
           const std::string& folder,
           std::uint64_t first_seed,
           std::uint64_t seeds) {
    const auto all = see_all(data, first_seed, seeds);
    if (!all) return all.error();
    const Coefficients best = fitted(*all);
    const Coefficients last = scaled(*all, best);
    auto out = fmt::output_file(folder + "/sigma_fit.csv");
    out.print("image,set,within_1,within_2,within_3\n");
    for (const auto& [set, c] : {std::pair("as it comes", kNow), std::pair("fitted", last)}) {
        fmt::print("{}: {:.3f}, loss {:.4f}\n", set, fmt::join(c, " "), loss(*all, c));
        for (const Seen& seen : *all)
            out.print("{},{},{:.1f}\n", seen.name, set, fmt::join(cover(seen, c), ","));
    }
    fmt::print("scale after the fit: {:.3f}\n", last[0] / best[0]);
    return {};
}

}  // namespace
}  // namespace surefoot::experiments

// An uncaught exception ends the experiment and prints its message. This is intended.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    using namespace surefoot;
    if (argc < 3) {
        fmt::print(stderr, "usage: sigma_fit STEREO_DATA_DIR OUT_DIR [FIRST_SEED [SEEDS]]\n");
        return 2;
    }
    const auto number = [&](int i, std::uint64_t otherwise) -> std::uint64_t {
        return argc > i ? std::strtoull(argv[i], nullptr, 10) : otherwise;
    };
    const auto done = experiments::run(argv[1], argv[2], number(3, 21), number(4, 4));
    return done ? 0 : app::report(done.error());
}
