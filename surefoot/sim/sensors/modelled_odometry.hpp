// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "surefoot/core/config.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/core/pose.hpp"

namespace surefoot::sim {

/// How fast a pose loses its way: one sigma of each axis after one metre of the camera's way.
/// Errors are a random walk, so that they grow with the root of the way; turning moves the camera
/// too. The defaults are this project's odometry with the images of the fitted ZED: `surefoot run
/// sim:SCENE --seed N --set sim.profile=zed` with floor and demo_stairs, seeds 1 and 2, then
/// `eval trajectory --align none`: over 0.1 to 2 m the relative errors of all three axes together
/// are 1.2-2.8 mm and 0.05-0.09 deg times the root of the way (means 1.8 mm and 0.065 deg).
struct DriftConfig {
    double position_m_sqrt_m = 0.001;
    double turn_deg_sqrt_m = 0.04;

    void describe(ConfigVisitor& visitor);
};

/// What visual odometry would say along a way that is known: the true motion, a random error, and
/// the covariance from which the error was drawn. Standing still has no error.
class ModelledOdometry {
  public:
    /// `T_body_camera`: of the camera whose way counts.
    ModelledOdometry(const DriftConfig& config, const Pose& T_body_camera, std::uint64_t seed);
    /// The next frame; its odom begins at the first base_link. Errors depend on (seed, frame) and
    /// the motion since the call before.
    [[nodiscard]] MotionEstimate follow(std::int64_t time_ns, int frame, const Pose& T_world_body);

  private:
    DriftConfig config_;
    Pose T_body_camera_;
    std::uint64_t seed_ = 0;
    std::optional<Pose> T_world_previous_;
    Pose T_odom_previous_;
};

}  // namespace surefoot::sim
