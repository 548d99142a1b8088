// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "surefoot/odometry/inertial/inertial_config.hpp"
#include "surefoot/odometry/inertial/inertial_start.hpp"

namespace surefoot::experiments {

/// The fusion of vision and IMU that the thesis proposes and never built (4.4), as a baseline:
/// differentiate the poses of visual odometry, average the velocities of both by their covariances,
/// add the average up to a pose again. Loosely coupled: vision is finished before the IMU is heard.
///
/// What the thesis leaves open: the speed of the IMU comes from its readings since the last fused
/// speed. Gravity, the gyroscope's bias and the first speed are found once from the first second of
/// vision (`start_inertial`, as the library does) and stay; what the biases may be wrong by counts
/// as noise. While vision is LOST its velocities count for nothing.
class VelocityFusion {
  public:
    /// `imu` must be that of the odometry; its IMU is base_link (EuRoC's rigs).
    explicit VelocityFusion(const odometry::InertialConfig& imu);

    /// The frame with the fused pose and motion; that of vision before the start and where samples
    /// are missing. The health stays that of vision.
    [[nodiscard]] MotionEstimate update(const MotionEstimate& vision,
                                        std::span<const ImuSample> samples);

  private:
    void start(const MotionEstimate& vision, const odometry::Preintegration& step);
    [[nodiscard]] MotionEstimate fused(const MotionEstimate& vision,
                                       const odometry::ImuMotion& imu);

    odometry::InertialConfig config_;
    std::vector<ImuSample> samples_;
    std::vector<odometry::SeenMotion> seen_;  ///< until the start
    std::optional<odometry::ImuBias> bias_;   ///< since then
    Eigen::Vector3d gravity_odom_m_s2_ = Eigen::Vector3d::Zero();
    Pose T_odom_body_;
    Eigen::Vector3d velocity_odom_m_s_ = Eigen::Vector3d::Zero();  ///< at the last frame
    Eigen::Matrix3d velocity_covariance_ = Eigen::Matrix3d::Zero();
    std::optional<std::int64_t> time_ns_;
};

}  // namespace surefoot::experiments
