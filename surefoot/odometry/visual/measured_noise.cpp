// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/visual/measured_noise.hpp"

#include <algorithm>

namespace surefoot::odometry {
namespace {

/// Largest ratio of the result to the expected noise: three times the noise of a calibrated ZED.
/// Larger residuals have another cause than noise.
constexpr double kMostNoise = 3.0;
/// Limits of the ratio of measured to expected noise. Scenes of one camera differ by up to
/// kTolerated, so the expected noise holds below this ratio. From kMeasured on the measured noise
/// counts fully; in between its weight grows. With kTolerated = 1.5, twice the ZED's noise gave a
/// NEES of 14 instead of 6 (corridor, seeds 21-24).
constexpr double kTolerated = 1.2;
constexpr double kMeasured = 1.5;
constexpr double kShare = 0.1;  ///< weight of one frame in the estimate, after the first ten

}  // namespace

void MeasuredNoise::listen(const camera::RectifiedRig& rig,
                           const PoseSolverConfig& config,
                           std::span<const PointMatch> matches,
                           const Pose& T_world_camera) {
    const auto scale = residual_scale_of_all(rig, config, matches, T_world_camera);
    if (!scale) return;
    frames_ += 1;
    const double share = std::max(1.0 / (frames_ + 1.0), kShare);
    measured_px_ += share * (*scale * config.sigma_px - measured_px_);
}

double MeasuredNoise::sigma_px() const noexcept {
    const double times = measured_px_ / expected_px_;
    const double rising = 1.0 + (kMeasured - 1.0) / (kMeasured - kTolerated) * (times - kTolerated);
    return expected_px_ * std::clamp(std::min(times, rising), 1.0, kMostNoise);
}

}  // namespace surefoot::odometry
