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

/// What the readings have too much.
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
    double gyro_range_rad_s = 0.0;  ///< readings at the range are saturated; 0 = unknown
    double accel_range_m_s2 = 0.0;  ///< as above, per axis
};

/// Why an interval has no preintegrated motion.
enum class ImuProblem : std::uint8_t {
    none,
    no_samples,  ///< none, or none near the interval
    gap,         ///< longer without a sample than the limit, within or at an end
    stamps,      ///< they repeat or go back, or the interval is empty
    not_finite,
    saturated,  ///< at the range; with an unknown range: high and exactly constant
};
[[nodiscard]] const char* to_string(ImuProblem problem) noexcept;

/// The motion between two instants as the IMU alone tells it, seen from the IMU at the first one
/// (i; the second is j), gravity left out:
///   R_j = R_i dR,  v_j = v_i + g dt + R_i dv,  p_j = p_i + v_i dt + g dt^2 / 2 + R_i dp.
///
/// Errors are ordered (rotation, velocity, position); that of the rotation perturbs on the right.
/// Forster, Carlone, Dellaert, Scaramuzza 2017, "On-Manifold Preintegration for Real-Time
/// Visual-Inertial Odometry".
struct ImuMotion {
    double dt_s = 0.0;
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    Matrix9 covariance = Matrix9::Zero();  ///< of the white noise; that of the biases is not in it
    ImuBias bias;                          ///< at which the readings were integrated
    Eigen::Matrix3d d_rotation_d_gyro = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d d_velocity_d_gyro = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d d_velocity_d_accel = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d d_position_d_gyro = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d d_position_d_accel = Eigen::Matrix3d::Zero();

    /// What other biases make of it, to first order in the change.
    [[nodiscard]] Eigen::Quaterniond rotation_at(const ImuBias& other) const;
    [[nodiscard]] Eigen::Vector3d velocity_at(const ImuBias& other) const;
    [[nodiscard]] Eigen::Vector3d position_at(const ImuBias& other) const;
};

struct Preintegration {
    ImuProblem problem = ImuProblem::no_samples;  ///< unless none, the motion means nothing
    ImuMotion motion;
};

/// Integrates the readings from `start_ns` to `end_ns` by the mid-point rule. The readings at the
/// ends are interpolated between their neighbours; without a neighbour on one side the nearest
/// reading holds, no longer than `limits.max_gap_s`. Samples outside of the interval may be given
/// and do no harm, the last before it and the first after it are used.
[[nodiscard]] Preintegration preintegrate(const ImuLimits& limits,
                                          const ImuNoise& noise,
                                          std::span<const ImuSample> samples,
                                          std::int64_t start_ns,
                                          std::int64_t end_ns,
                                          const ImuBias& bias);

/// Exp(theta + d) = Exp(theta) Exp(J d) to first order in d; Chirikjian 2012, (10.86).
[[nodiscard]] Eigen::Matrix3d right_jacobian_so3(const Eigen::Vector3d& theta_rad);
/// Its inverse: Log(Exp(theta) Exp(d)) = theta + J^-1 d; for |theta| < pi.
[[nodiscard]] Eigen::Matrix3d inverse_right_jacobian_so3(const Eigen::Vector3d& theta_rad);

}  // namespace surefoot::odometry
