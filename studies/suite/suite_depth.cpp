// SPDX-License-Identifier: Apache-2.0
#include "studies/suite/suite_depth.hpp"

#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "studies/runs/sim_truth.hpp"
#include "surefoot/eval/depth/sparsification.hpp"

namespace surefoot::app {
namespace {

constexpr int kEvery = 5;  ///< uses every n-th frame; neighbouring frames look nearly the same

/// Returns estimated minus true disparity [px]. NaN = one of the two is unknown.
std::vector<float> disparity_errors(const Image<float>& truth_m,
                                    const pipeline::Pipeline& pipeline) {
    const Image<float>& disparity_px = pipeline.depth().disparity_px;
    const double fb_px_m = pipeline.rig().depth_to_disparity_px_m();
    std::vector<float> errors(truth_m.size(), std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = 0; i < errors.size(); ++i) {
        const auto estimate_px = static_cast<double>(disparity_px.data()[i]);
        const auto true_z_m = static_cast<double>(truth_m.data()[i]);
        if (estimate_px > 0.0 && true_z_m > 0.0)
            errors[i] = static_cast<float>(estimate_px - fb_px_m / true_z_m);
    }
    return errors;
}

}  // namespace

void DepthOrder::after_frame(const FrameReport& frame,
                             const sim::SceneSource& source,
                             const pipeline::Pipeline& pipeline) {
    ++seen_;
    const bool straight = seen_ >= static_cast<int>(pipeline::Pipeline::kAlignmentFrames);
    const bool wanted = straight && seen_ % kEvery == 0 && frame.work == Work::full;
    // Skips raw images, because their true depth belongs to other pixels than the rectified
    // disparity.
    if (!wanted || !source.rig().rectified) return;
    const Image<float> truth_m = depth_seen_by(pipeline.rig(), source.rig(), source.last_depth_m());
    if (truth_m.empty()) return;
    const DepthImage& depth = pipeline.depth();
    const auto errors_px = disparity_errors(truth_m, pipeline);
    const double auc =
        eval::sparsification(errors_px, {depth.sigma_px.data(), depth.sigma_px.size()}).auc;
    if (std::isnan(auc)) return;
    sum_ += auc;
    ++measured_;
}

double DepthOrder::auc() const {
    return measured_ > 0 ? sum_ / measured_ : std::nan("");
}

}  // namespace surefoot::app
