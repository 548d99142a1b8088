// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "surefoot/core/config.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/core/pose.hpp"

namespace surefoot::sim {

/// Drift of a pose: one sigma of each axis after the camera has moved one metre. The errors are a
/// random walk and grow with the square root of the distance; a turn moves the camera too.
/// Defaults: this project's odometry on images of the fitted ZED: `surefoot run sim:SCENE --seed N
/// --set sim.profile=zed` on floor and demo_stairs, seeds 1 and 2, then `eval trajectory --align
/// none`. From 0.1 to 2 m the relative errors of all three axes together are 1.2-2.8 mm and
/// 0.05-0.09 deg times the root of the distance (means 1.8 mm and 0.065 deg).
struct DriftConfig {
    double position_m_sqrt_m = 0.001;
    double turn_deg_sqrt_m = 0.04;

    void describe(ConfigVisitor& visitor);
};

/// Simulated output of visual odometry along a known path: the true motion, a random error, and the
/// covariance from which the error was drawn. Standing still adds no error.
class ModelledOdometry {
  public:
    /// `T_body_camera`: mount of the camera whose path length drives the drift.
    ModelledOdometry(const DriftConfig& config, const Pose& T_body_camera, std::uint64_t seed);
    /// Adds the next frame; odom begins at the first base_link. Errors depend on (seed, frame) and
    /// on the motion since the previous call.
    [[nodiscard]] MotionEstimate follow(std::int64_t time_ns, int frame, const Pose& T_world_body);

  private:
    DriftConfig config_;
    Pose T_body_camera_;
    std::uint64_t seed_ = 0;
    std::optional<Pose> T_world_previous_;
    Pose T_odom_previous_;
};

}  // namespace surefoot::sim
