// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/odometry/visual/pose_solver.hpp"

namespace surefoot::odometry {

/// How noisy the points of this camera are, learnt from how far they are off the poses.
///
/// The residuals that a gate lets pass say little of a noise that the gate is too narrow for. The
/// median of all of them, outliers included, says it while less than half are outliers. It is
/// learnt slowly, so that somebody who walks by does not open the gates for himself.
class MeasuredNoise {
  public:
    /// `expected_px`: one sigma of a point, per eye and axis. The noise is never taken for less,
    /// nor for more than thrice that; what is measured counts where it is clearly more.
    explicit MeasuredNoise(double expected_px)
        : expected_px_(expected_px), measured_px_(expected_px) {}

    /// A frame whose pose is known; `config.sigma_px` is `sigma_px()`.
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
