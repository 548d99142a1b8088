// SPDX-License-Identifier: Apache-2.0
// Does the stated uncertainty of the matcher agree with its real errors? Input: Middlebury pairs
// and images of the simulated ZED. The coefficients of the uncertainty come from sigma_fit.
// Usage: matcher_sigma STEREO_DATA_DIR OUT_DIR [FIRST_SEED]     default seed: 1
//
// Writes OUT_DIR/sigma.csv: kind,source,count,within_1,within_2,within_3,density,auc_sigma,auc_peak
//   kind                image, or pooled: all matches of one type of images together
//   count, within_1 to within_3   trusted matches that are right within 1 px, and the share of them
//                       within 1, 2 and 3 sigma [%]
//   density             share of matched pixels [%]
//   auc_sigma, auc_peak eval::sparsification over all matches, ordered by sigma, and by the
//                       ratio of the best cost to the second-best; 0 = perfect, 1 = random order
#include <fmt/format.h>
#include <fmt/os.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "lab/stereo_pairs/rival_matchers.hpp"
#include "lab/stereo_pairs/stereo_pairs.hpp"
#include "service/console/log.hpp"
#include "surefoot/eval/depth/sparsification.hpp"
#include "surefoot/stereo/semi_global.hpp"

namespace surefoot::experiments {
namespace {

/// Returns the best cost divided by the second-best cost for each pixel; large = uncertain.
Image<float> peak_doubt(const TruePair& pair) {
    stereo::SemiGlobalConfig config;
    config.disparities = pair.disparities;
    Serial serial;
    stereo::Winners winners;
    stereo::SemiGlobalSearch(config).search(pair.left.view(), pair.right.view(), serial, winners);
    Image<float> doubt(pair.left.width(), pair.left.height());
    for (std::size_t i = 0; i < doubt.size(); ++i) {
        doubt.data()[i] = static_cast<float>(winners.cost.data()[i] + 1) /
                          static_cast<float>(winners.second_cost.data()[i] + 1);
    }
    return doubt;
}

/// Stated sigmas and real errors of matches, from one image or several.
struct Confidences {
    std::vector<float> errors_px;  ///< one per match, in the order of sigmas_px and peak_doubts
    std::vector<float> sigmas_px;
    std::vector<float> peak_doubts;
    std::array<double, 3> within{};  ///< number of trusted matches within 1, 2 and 3 sigma
    double trusted = 0.0;
    double pixels = 0.0;

    void add(const TruePair& pair);
    void add(const Confidences& other);
    void print(fmt::ostream& out, const char* kind, const std::string& source) const;
};

void Confidences::add(const TruePair& pair) {
    const DepthImage depth = chain_depth(pair);
    const Image<float> doubt = peak_doubt(pair);
    for (std::size_t i = 0; i < doubt.size(); ++i) {
        if (std::isnan(pair.truth_px.data()[i])) continue;
        ++pixels;
        const float error_px = depth.disparity_px.data()[i] - pair.truth_px.data()[i];
        if (std::isnan(error_px)) continue;
        errors_px.push_back(error_px);
        // Combines sigma and outlier probability: outlier probability 1 adds 4 px to sigma.
        const float p = depth.outlier_probability.data()[i];
        sigmas_px.push_back(depth.sigma_px.data()[i] + 4.0F * p);
        peak_doubts.push_back(doubt.data()[i]);
        if (p > kTrustedOutlierProbability || std::abs(error_px) > 1.0F) continue;
        const double sigma_px = std::hypot(static_cast<double>(depth.sigma_px.data()[i]),
                                           pair.step_px / std::sqrt(12.0));
        ++trusted;
        for (std::size_t k = 0; k < within.size(); ++k) {
            const double limit_px = static_cast<double>(k + 1) * sigma_px;
            within[k] += std::abs(static_cast<double>(error_px)) <= limit_px ? 1.0 : 0.0;
        }
    }
}

void Confidences::add(const Confidences& other) {
    const auto append = [](std::vector<float>& to, const std::vector<float>& from) {
        to.insert(to.end(), from.begin(), from.end());
    };
    append(errors_px, other.errors_px);
    append(sigmas_px, other.sigmas_px);
    append(peak_doubts, other.peak_doubts);
    for (std::size_t k = 0; k < within.size(); ++k) within[k] += other.within[k];
    trusted += other.trusted;
    pixels += other.pixels;
}

void Confidences::print(fmt::ostream& out, const char* kind, const std::string& source) const {
    out.print("{},{},{},{:.1f},{:.1f},{:.1f},{:.1f},{:.4f},{:.4f}\n",
              kind,
              source,
              trusted,
              100.0 * within[0] / trusted,
              100.0 * within[1] / trusted,
              100.0 * within[2] / trusted,
              100.0 * static_cast<double>(errors_px.size()) / pixels,
              eval::sparsification(errors_px, sigmas_px).auc,
              eval::sparsification(errors_px, peak_doubts).auc);
}

/// Writes one line for each pair and one line for all pairs together.
void report_sigmas_of(fmt::ostream& out,
                      const std::string& name,
                      const std::vector<TruePair>& pairs) {
    Confidences all;
    for (const TruePair& pair : pairs) {
        Confidences one;
        one.add(pair);
        one.print(out, "image", pair.name);
        all.add(one);
    }
    all.print(out, "pooled", name);
}

Result<std::vector<TruePair>> simulated_pairs(sim::SceneOptions options) {
    constexpr const char* kScenes[] = {"demo_stairs",
                                       "floor",
                                       "sill_13",
                                       "stairs_up_ada",
                                       "kerb_down_150",
                                       "table",
                                       "glass_door",
                                       "stripes_window"};
    std::vector<TruePair> pairs;
    pairs.reserve(std::size(kScenes));
    for (const char* scene : kScenes) {
        options.scene = scene;
        auto pair = simulated_pair(options);
        if (!pair) return pair.error();
        pairs.push_back(std::move(*pair));
        ++options.seed;
    }
    return pairs;
}

Status report_sigmas(const std::string& file,
                     std::vector<TruePair> pairs,
                     std::uint64_t first_seed) {
    auto out = fmt::output_file(file);
    out.print("kind,source,count,within_1,within_2,within_3,density,auc_sigma,auc_peak\n");
    // A truth in whole pixels cannot measure sub-pixel errors.
    std::erase_if(pairs, [](const TruePair& pair) { return pair.step_px >= 1.0; });
    report_sigmas_of(out, "real pairs", pairs);
    sim::SceneOptions options;
    options.seed = first_seed;
    for (const sim::CameraProfile profile : {sim::CameraProfile::zed, sim::CameraProfile::ideal}) {
        options.profile = profile;
        for (const double noise : {1.0, 2.0}) {
            options.noise = noise;
            const auto seen = simulated_pairs(options);
            if (!seen) return seen.error();
            report_sigmas_of(
                out,
                fmt::format("{} x {:g}",
                            sim::kCameraProfileNames[static_cast<std::size_t>(profile)],
                            noise),
                *seen);
        }
    }
    return {};
}

Status run(const std::string& data, const std::string& folder, std::uint64_t first_seed) {
    auto pairs = middlebury_pairs(data);
    if (!pairs) return pairs.error();
    return report_sigmas(folder + "/sigma.csv", std::move(*pairs), first_seed);
}

}  // namespace
}  // namespace surefoot::experiments

// An uncaught exception ends the experiment and prints its message. This is intended.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    using namespace surefoot;
    if (argc < 3) {
        fmt::print(stderr, "usage: matcher_sigma STEREO_DATA_DIR OUT_DIR [FIRST_SEED]\n");
        return 2;
    }
    const std::uint64_t first_seed = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1;
    const auto done = experiments::run(argv[1], argv[2], first_seed);
    return done ? 0 : app::report(done.error());
}
