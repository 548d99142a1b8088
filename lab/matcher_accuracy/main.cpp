// SPDX-License-Identifier: Apache-2.0
// How accurate is our matcher compared with OpenCV's matchers on Middlebury pairs? matcher_sigma
// measures the calibration of its uncertainty.
// Usage: matcher_accuracy STEREO_DATA_DIR OUT_DIR
//
// Writes into OUT_DIR:
//   truth.csv  pair,matcher,count,q10,q25,q50,q75,q90,q50_far,q50_near: quantiles of matched minus
//              true disparity [px], over matches within 2 px (ours: only trusted ones); medians of
//              the halves with the smaller (far) and the larger (near) true disparities
//   pairs.csv  truth,pair,matcher,bad_1,bad_2,density,cpu_ms: each matcher with its default
//              settings. Share of the pixels seen by both cameras with an error above 1 or 2 px
//              [%]; unknown pixels are filled from the smaller horizontal neighbour; all
//              disparities are rounded to 1/16 px
#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "lab/stereo_pairs/rival_matchers.hpp"
#include "lab/stereo_pairs/stereo_pairs.hpp"
#include "service/console/log.hpp"

namespace surefoot::experiments {
namespace {

/// Returns the quantile: `share` of the values are smaller than it. Reorders `values`.
float quantile(std::vector<float>& values, double share) {
    if (values.empty()) return std::numeric_limits<float>::quiet_NaN();
    const auto at = values.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// Writes the quantiles of matched minus true disparity. With rounded truth they are centred on
/// zero; truncated truth shifts them up.
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

int run(const std::string& data, const std::string& folder) {
    const auto pairs = middlebury_pairs(data);
    if (!pairs) return app::report(pairs.error());
    report_truth(folder + "/truth.csv", *pairs);
    report_pairs(folder + "/pairs.csv", *pairs);
    return 0;
}

}  // namespace
}  // namespace surefoot::experiments

// An uncaught exception ends the experiment and prints its message. This is intended.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    if (argc < 3) {
        fmt::print(stderr, "usage: matcher_accuracy STEREO_DATA_DIR OUT_DIR\n");
        return 2;
    }
    cv::setNumThreads(1);
    return surefoot::experiments::run(argv[1], argv[2]);
}
