// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "surefoot/core/config.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/core/pose.hpp"

namespace surefoot::pipeline {

/// A direction in base_link with its uncertainty.
struct Direction {
    Eigen::Vector3d unit_body = Eigen::Vector3d::UnitZ();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< error of `unit_body` [rad^2], rank 2

    /// One sigma about any axis across the direction: root of the mean of the two variances.
    [[nodiscard]] double sigma_rad() const;
};

/// Prior knowledge about the direction of gravity before a start.
///
/// The ground plane measures the floor, not gravity; the difference is the slope of the floor. Most
/// floors are built level, some are ramps or fall to one side. So the model draws the slope about
/// each horizontal axis from one of two normal distributions.
struct GravityConfig {
    /// One sigma of the constant error of the accelerometer along each axis, including the error of
    /// its alignment with the camera. Calibrated MEMS parts stay within 0.02 m/s^2. By their data
    /// sheets, other parts err by 0.2 to 0.6 m/s^2.
    double accel_bias_m_s2 = 0.02;
    /// One sigma of the slope of floors that are built level: DIN 18202 allows 4 mm over 1 m.
    /// ASSUMPTION.
    double level_floor_deg = 0.1;
    /// One sigma of the slope of all other floors: 3.4 sigma reach the steepest ramp that
    /// accessible building codes allow, 1:12. ASSUMPTION.
    double sloped_floor_deg = 1.4;
    double sloped_share = 0.2;  ///< prior share of starts on sloped floors. ASSUMPTION

    void describe(ConfigVisitor& visitor);
};

/// Returns the up direction that the accelerometer measures while the rig stands still. Empty with
/// fewer than 10 samples, if the rig turns faster than `still_gyro_rad_s`, or if the force differs
/// from 9.81 m/s^2 by more than `still_force_m_s2`. The uncertainty covers a constant error, which
/// grows if the force has a wrong length. It also covers the change of direction between the two
/// halves of the samples.
[[nodiscard]] std::optional<Direction> up_from_imu(const GravityConfig& config,
                                                   double still_gyro_rad_s,
                                                   double still_force_m_s2,
                                                   const Pose& T_body_imu,
                                                   std::span<const StereoFrame> frames);

/// Returns the up direction if only the ground plane is known: its normal. The plane alone cannot
/// distinguish a level floor from a ramp. So the uncertainty covers sloped floors.
[[nodiscard]] Direction up_from_plane(const GravityConfig& config, const Direction& normal);

/// Up direction from both sources, and the probability that the floor was built level.
struct FusedUp {
    Direction up;
    double level_probability = 0.0;
};

/// Fuses the two sources by Bayes' rule over the two kinds of floor. Each kind is a linear Kalman
/// update; the mixture of both is reduced to its first two moments. On a probably level floor, the
/// plane corrects the accelerometer's constant error. On a ramp, the plane has little weight.
[[nodiscard]] FusedUp fuse_up(const GravityConfig& config,
                              const Direction& normal,
                              const Direction& up_imu);

}  // namespace surefoot::pipeline
