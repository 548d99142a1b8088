// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "surefoot/odometry/inertial/inertial_config.hpp"
#include "surefoot/odometry/inertial/inertial_start.hpp"

namespace surefoot::experiments {

/// Loosely coupled fusion of visual odometry and IMU, as a baseline. The reference thesis (Lange
/// 2016, section 4.4) proposes three steps without an implementation: differentiate the visual
/// poses; average the visual and the IMU velocity by their covariances; integrate the average to a
/// pose. The visual motion is final before the IMU is used.
///
/// The thesis leaves some points open. This class decides them as follows. The IMU velocity is
/// integrated from the last fused velocity. Gravity, gyroscope bias and first velocity are
/// estimated once, from the first second of vision (`start_inertial`, as in the library), and then
/// stay constant. The uncertainty of the biases counts as noise. While vision is LOST, its velocity
/// has no weight.
class VelocityFusion {
  public:
    /// `imu`: the configuration that the odometry uses. The IMU frame must be base_link, as in the
    /// EuRoC rigs.
    explicit VelocityFusion(const odometry::InertialConfig& imu);

    /// Returns `vision` with the fused pose and motion. Before the start, and where IMU samples are
    /// missing, the motion is that of vision. The health is always that of vision. `samples`: IMU
    /// samples since the last call.
    [[nodiscard]] MotionEstimate update(const MotionEstimate& vision,
                                        std::span<const ImuSample> samples);

  private:
    void start(const MotionEstimate& vision, const odometry::Preintegration& step);
    [[nodiscard]] MotionEstimate fused(const MotionEstimate& vision,
                                       const odometry::ImuMotion& imu);

    odometry::InertialConfig config_;
    std::vector<ImuSample> samples_;
    std::vector<odometry::SeenMotion> seen_;  ///< motions of vision before the start
    std::optional<odometry::ImuBias> bias_;   ///< empty before the start
    Eigen::Vector3d gravity_odom_m_s2_ = Eigen::Vector3d::Zero();
    Pose T_odom_body_;
    Eigen::Vector3d velocity_odom_m_s_ = Eigen::Vector3d::Zero();  ///< velocity at the last frame
    Eigen::Matrix3d velocity_covariance_ = Eigen::Matrix3d::Zero();
    std::optional<std::int64_t> time_ns_;
};

}  // namespace surefoot::experiments
