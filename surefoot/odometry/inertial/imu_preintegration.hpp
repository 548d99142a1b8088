// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>

#include "surefoot/core/frame.hpp"

namespace surefoot::odometry {

using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;

/// Constant errors of the readings: reading = true value + bias.
struct ImuBias {
    Eigen::Vector3d gyro_rad_s = Eigen::Vector3d::Zero();
    Eigen::Vector3d accel_m_s2 = Eigen::Vector3d::Zero();
};

/// Densities of the white noise and of the biases' random walks.
struct ImuNoise {
    double gyro_density_rad_s_sqrt_hz = 1e-3;
    double accel_density_m_s2_sqrt_hz = 1e-2;
    double gyro_walk_rad_s2_sqrt_hz = 1e-4;
    double accel_walk_m_s3_sqrt_hz = 3e-3;
};

struct ImuLimits {
    double max_gap_s = 0.03;        ///< longest time without a sample
    double gyro_range_rad_s = 0.0;  ///< range; readings at the range are saturated; 0 = unknown
    double accel_range_m_s2 = 0.0;  ///< range; readings at the range are saturated; 0 = unknown
};

/// Reason why an interval has no preintegrated motion.
enum class ImuProblem : std::uint8_t {
    none,
    no_samples,  ///< the list is empty, or no sample is near the interval
    gap,         ///< no sample for longer than the limit, inside or at an end
    stamps,      ///< stamps repeat or go back, or the interval is empty
    not_finite,
    saturated,  ///< a reading is at its range limit, or is high and exactly constant
};
[[nodiscard]] const char* to_string(ImuProblem problem) noexcept;

/// Motion between two instants i and j from the IMU alone, in the axes of the IMU at i, without the
/// effect of gravity:
///   R_j = R_i dR,  v_j = v_i + g dt + R_i dv,  p_j = p_i + v_i dt + g dt^2 / 2 + R_i dp.
///
/// Error order: rotation, velocity, position. The rotation error perturbs on the right. Forster,
/// Carlone, Dellaert, Scaramuzza 2017, "On-Manifold Preintegration for Real-Time Visual-Inertial
/// Odometry".
struct ImuMotion {
    double dt_s = 0.0;
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    Matrix9 covariance = Matrix9::Zero();  ///< covariance of the white noise, without the biases
    ImuBias bias;                          ///< bias used during the integration
    Eigen::Matrix3d d_rotation_d_gyro = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d d_velocity_d_gyro = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d d_velocity_d_accel = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d d_position_d_gyro = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d d_position_d_accel = Eigen::Matrix3d::Zero();

    /// These functions return the motion for another bias, to first order in the change of bias.
    [[nodiscard]] Eigen::Quaterniond rotation_at(const ImuBias& other) const;
    [[nodiscard]] Eigen::Vector3d velocity_at(const ImuBias& other) const;
    [[nodiscard]] Eigen::Vector3d position_at(const ImuBias& other) const;
};

struct Preintegration {
    ImuProblem problem = ImuProblem::no_samples;  ///< if not `none`, `motion` is invalid
    ImuMotion motion;
};

/// Integrates the readings from `start_ns` to `end_ns` by the mid-point rule. Readings at the ends
/// are interpolated between their neighbours. If one side has no neighbour, the nearest reading is
/// held for at most `limits.max_gap_s`. `samples` may reach beyond the interval. Outside it, only
/// the last sample before and the first sample after it are used.
[[nodiscard]] Preintegration preintegrate(const ImuLimits& limits,
                                          const ImuNoise& noise,
                                          std::span<const ImuSample> samples,
                                          std::int64_t start_ns,
                                          std::int64_t end_ns,
                                          const ImuBias& bias);

/// Returns J in Exp(theta + d) = Exp(theta) Exp(J d), first order in d; Chirikjian 2012, (10.86).
[[nodiscard]] Eigen::Matrix3d right_jacobian_so3(const Eigen::Vector3d& theta_rad);
/// Inverse of right_jacobian_so3: Log(Exp(theta) Exp(d)) = theta + J^-1 d; for |theta| < pi.
[[nodiscard]] Eigen::Matrix3d inverse_right_jacobian_so3(const Eigen::Vector3d& theta_rad);

}  // namespace surefoot::odometry
