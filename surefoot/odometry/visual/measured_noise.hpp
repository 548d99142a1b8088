// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/odometry/visual/pose_solver.hpp"

namespace surefoot::odometry {

/// Estimates the pixel noise of this camera's points from their residuals.
///
/// The residuals inside a gate say little about noise that is too large for the gate. The median of
/// the residuals in the wider RANSAC gate measures it if less than half of them are outliers. The
/// estimate changes slowly, so that a person who walks by does not widen the gates.
class MeasuredNoise {
  public:
    /// `expected_px`: one sigma of a point, per camera and axis. The result is at least this value
    /// and at most three times this value; a measurement counts only when it is clearly larger.
    explicit MeasuredNoise(double expected_px)
        : expected_px_(expected_px), measured_px_(expected_px) {}

    /// Adds a frame with known pose. `config.sigma_px` must be `sigma_px()`.
    void listen(const camera::RectifiedRig& rig,
                const PoseSolverConfig& config,
                std::span<const PointMatch> matches,
                const Pose& T_world_camera);
    [[nodiscard]] double sigma_px() const noexcept;

  private:
    double expected_px_;
    double measured_px_;
    int frames_ = 0;
};

}  // namespace surefoot::odometry
