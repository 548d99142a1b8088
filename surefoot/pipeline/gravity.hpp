// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "surefoot/core/config.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/core/pose.hpp"

namespace surefoot::pipeline {

/// A direction in base_link and how sure it is.
struct Direction {
    Eigen::Vector3d unit_body = Eigen::Vector3d::UnitZ();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of the unit vector [rad^2], rank 2

    /// One sigma about any axis across the direction: the root of the mean of both variances.
    [[nodiscard]] double sigma_rad() const;
};

/// What is known of the direction of gravity before a start.
///
/// The plane of the ground measures the floor, not gravity: between them lies the slope of the
/// floor. Most floors are built level, some are ramps or fall to one side. The slope about each
/// horizontal axis is therefore drawn from one of two normal distributions.
struct GravityConfig {
    /// One sigma of the constant error of the accelerometer along each axis, alignment with the
    /// camera included. Calibrated MEMS parts keep 0.02; parts that were never calibrated err by
    /// 0.2 to 0.6 by their data sheets.
    double accel_bias_m_s2 = 0.02;
    /// One sigma of the slope of floors that are built level: DIN 18202 allows 4 mm over 1 m.
    /// ASSUMPTION.
    double level_floor_deg = 0.1;
    /// The same for all other floors: 3.4 sigma reach the steepest ramp of the accessible building
    /// codes, 1:12. ASSUMPTION.
    double sloped_floor_deg = 1.4;
    double sloped_share = 0.2;  ///< of the places where a run starts. ASSUMPTION

    void describe(ConfigVisitor& visitor);
};

/// Up as the accelerometer measures it while the rig stands still: nothing without samples, or
/// while it turns faster than `still_gyro_rad_s` or its force is off 9.81 m/s^2 by more than
/// `still_force_m_s2`. The uncertainty is that of a constant error, larger where the length of the
/// force shows a larger one, and of what the direction changed between the first and the second
/// half of the samples.
[[nodiscard]] std::optional<Direction> up_from_imu(const GravityConfig& config,
                                                   double still_gyro_rad_s,
                                                   double still_force_m_s2,
                                                   const Pose& T_body_imu,
                                                   std::span<const StereoFrame> frames);

/// Up where nothing but the plane of the ground is known: its normal. Nothing tells a level floor
/// from a ramp, so that the uncertainty is that of sloped floors.
[[nodiscard]] Direction up_from_plane(const GravityConfig& config, const Direction& normal);

/// Up from both, and how likely the floor is one that was built level.
struct FusedUp {
    Direction up;
    double level_probability = 0.0;
};

/// Bayes' rule for the two kinds of floor, both of them linear and normal (a mixture of two Kalman
/// updates, put together by its first two moments): the plane corrects the accelerometer's constant
/// error on a floor that may be level, and has hardly a say on a ramp.
[[nodiscard]] FusedUp fuse_up(const GravityConfig& config,
                              const Direction& normal,
                              const Direction& up_imu);

}  // namespace surefoot::pipeline
