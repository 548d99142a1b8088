// SPDX-License-Identifier: Apache-2.0
// How right is the matcher, and does it know? Beside OpenCV's, on Middlebury pairs and on the
// simulated ZED.
// Usage: matcher_accuracy STEREO_DATA_DIR OUT_DIR [FIRST_SEED]
//
// truth.csv    pair,matcher,count,q10,q25,q50,q75,q90,q50_far,q50_near: matched less true disparity
//              [px] of the matches that are trusted (ours) and within 2 px; the median also of the
//              smaller and of the larger half of the true disparities
// pairs.csv    truth,pair,matcher,bad_1,bad_2,density,cpu_ms: every matcher as it comes; share of
// the
//              pixels that both eyes see which are wrong by more than 1 or 2 px, unknown ones
//              filled from the smaller horizontal neighbour, all rounded to 1/16 px
// sigma.csv    kind,source,count,within_1,within_2,within_3,density,auc_sigma,auc_peak: trusted
// matches
//              that are right within 1 px; the order of sigma and, instead, that of the cost of the
//              second best over the best, judged by eval::sparsification over all matches; kinds:
//              "image", and "pooled": all matches of one kind of images together
#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "apps/surefoot/log.hpp"
#include "eval/sparsification.hpp"
#include "experiments/rival_matchers.hpp"
#include "experiments/stereo_pairs.hpp"
#include "surefoot/stereo/matcher.hpp"

namespace surefoot::experiments {
namespace {

/// Disorders `values`; `share` of them are smaller.
float quantile(std::vector<float>& values, double share) {
    if (values.empty()) return std::numeric_limits<float>::quiet_NaN();
    const auto at = values.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// Rounded truth leaves residuals around zero; truth that was cut leaves them above it.
void report_residuals(fmt::ostream& out,
                      const TruePair& pair,
                      const char* matcher,
                      const Image<float>& disparity_px) {
    constexpr float kRight_px = 2.0F;
    std::vector<float> truths_px;
    for (std::size_t i = 0; i < disparity_px.size(); ++i) {
        if (!std::isnan(pair.truth_px.data()[i])) truths_px.push_back(pair.truth_px.data()[i]);
    }
    const float middle_px = quantile(truths_px, 0.5);
    std::vector<float> all_px, far_px, near_px;
    for (std::size_t i = 0; i < disparity_px.size(); ++i) {
        const float truth_px = pair.truth_px.data()[i];
        const float residual_px = disparity_px.data()[i] - truth_px;
        if (!(std::abs(residual_px) <= kRight_px)) continue;
        all_px.push_back(residual_px);
        (truth_px <= middle_px ? far_px : near_px).push_back(residual_px);
    }
    out.print("{},{},{}", pair.name, matcher, all_px.size());
    for (const double share : {0.1, 0.25, 0.5, 0.75, 0.9})
        out.print(",{:.3f}", quantile(all_px, share));
    out.print(",{:.3f},{:.3f}\n", quantile(far_px, 0.5), quantile(near_px, 0.5));
}

void report_truth(const std::string& file, const std::vector<TruePair>& pairs) {
    auto out = fmt::output_file(file);
    out.print("pair,matcher,count,q10,q25,q50,q75,q90,q50_far,q50_near\n");
    const Match ours = trusted_chain();
    const Match theirs = opencv_sgbm({.mode = cv::StereoSGBM::MODE_HH4});
    for (const TruePair& pair : pairs) {
        report_residuals(out, pair, "ours", ours(pair));
        report_residuals(out, pair, "OpenCV HH4", theirs(pair));
    }
}

void report(fmt::ostream& out,
            const std::string& name,
            const Match& match,
            const std::vector<TruePair>& pairs) {
    for (const TruePair& pair : pairs) {
        const std::clock_t start = std::clock();
        const Image<float> disparity_px = match(pair);
        const double cpu_ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        for (const Truth truth : {Truth::as_published, Truth::centred}) {
            const Score s = score(pair, disparity_px, truth);
            out.print("{},{},{},{:.3f},{:.3f},{:.2f},{:.1f}\n",
                      kTruthNames[static_cast<std::size_t>(truth)],
                      pair.name,
                      name,
                      s.bad_1,
                      s.bad_2,
                      s.density,
                      cpu_ms);
        }
    }
}

void report_pairs(const std::string& file, const std::vector<TruePair>& pairs) {
    auto out = fmt::output_file(file);
    out.print("truth,pair,matcher,bad_1,bad_2,density,cpu_ms\n");
    for (const Candidate& candidate : candidates())
        report(out, candidate.name, candidate.as_it_comes, pairs);
}

/// Cost of the second best over that of the best, upside down: large = unsure.
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

/// What sigma said of matches, and how wrong they were; of one image, or of several together.
struct Confidences {
    std::vector<float> errors_px;  ///< of all matches; their doubts in the same order
    std::vector<float> sigmas_px;
    std::vector<float> peak_doubts;
    std::array<double, 3> within{};  ///< trusted matches within 1, 2, 3 sigma
    double trusted = 0.0;
    double pixels = 0.0;

    void add(const TruePair& pair);
    void add(const Confidences& other);
    void print(fmt::ostream& out, const char* kind, const std::string& source) const;
};

void Confidences::add(const TruePair& pair) {
    const camera::DepthImage depth = chain_depth(pair);
    const Image<float> doubt = peak_doubt(pair);
    for (std::size_t i = 0; i < doubt.size(); ++i) {
        if (std::isnan(pair.truth_px.data()[i])) continue;
        ++pixels;
        const float error_px = depth.disparity_px.data()[i] - pair.truth_px.data()[i];
        if (std::isnan(error_px)) continue;
        errors_px.push_back(error_px);
        // One number for both kinds of doubt: what is likely wrong counts as wrong by pixels.
        const float p = depth.outlier_probability.data()[i];
        sigmas_px.push_back(depth.sigma_px.data()[i] + 4.0F * p);
        peak_doubts.push_back(doubt.data()[i]);
        if (p > kTrusted || std::abs(error_px) > 1.0F) continue;
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

/// Each of them, then all of them together.
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
    // Truth in whole pixels says nothing.
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

int run(const std::string& data, const std::string& folder, std::uint64_t first_seed) {
    const auto pairs = middlebury_pairs(data);
    if (!pairs) return app::report(pairs.error());
    report_truth(folder + "/truth.csv", *pairs);
    report_pairs(folder + "/pairs.csv", *pairs);
    const auto done = report_sigmas(folder + "/sigma.csv", *pairs, first_seed);
    return done ? 0 : app::report(done.error());
}

}  // namespace
}  // namespace surefoot::experiments

// An exception ends an experiment with its message, as it should.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    if (argc < 3) {
        fmt::print(stderr, "usage: matcher_accuracy STEREO_DATA_DIR OUT_DIR [FIRST_SEED]\n");
        return 2;
    }
    cv::setNumThreads(1);
    const std::uint64_t first_seed = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1;
    return surefoot::experiments::run(argv[1], argv[2], first_seed);
}
