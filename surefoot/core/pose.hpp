// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace surefoot {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Rigid motion. `T_a_b` maps coordinates from b into a: `p_a = T_a_b * p_b`. The inner names
/// cancel: `T_a_c = T_a_b * T_b_c`.
///
/// Errors and covariances are ordered (translation, rotation). They perturb on the right, in the
/// body frame b: R = R0 Exp(theta), t = t0 + R0 dp, with the 6-vector (dp, theta).
struct Pose {
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();

    [[nodiscard]] Pose inverse() const;
    [[nodiscard]] Eigen::Matrix3d R() const { return rotation.toRotationMatrix(); }
    [[nodiscard]] Eigen::Matrix4d matrix() const;
    /// Returns the pose of a rigid 4x4 matrix; normalises the quaternion of its rotation.
    [[nodiscard]] static Pose from_matrix(const Eigen::Matrix4d& T_a_b);
    [[nodiscard]] bool all_finite() const;
};

/// Pose of a body at one instant. The world frame is that of the recording or of the file.
struct StampedPose {
    std::int64_t time_ns = 0;
    Pose T_world_body;
};
using Trajectory = std::vector<StampedPose>;

[[nodiscard]] Pose operator*(const Pose& T_a_b, const Pose& T_b_c);
[[nodiscard]] Eigen::Vector3d operator*(const Pose& T_a_b, const Eigen::Vector3d& p_b);

/// Returns the cross-product matrix: skew(a) * b = a x b.
[[nodiscard]] Eigen::Matrix3d skew(const Eigen::Vector3d& v);
/// Returns the rotation by the vector `theta_rad` (axis times angle).
[[nodiscard]] Eigen::Quaterniond exp_so3(const Eigen::Vector3d& theta_rad);
/// Returns the rotation vector of shortest length, |theta| <= pi.
[[nodiscard]] Eigen::Vector3d log_so3(const Eigen::Quaterniond& rotation);

/// Returns T perturbed on the right by (dp, theta); `difference` is its inverse.
[[nodiscard]] Pose perturbed(const Pose& T, const Vector6& delta);
/// Returns the (dp, theta) with `to == perturbed(from, difference(from, to))`.
[[nodiscard]] Vector6 difference(const Pose& from, const Pose& to);

/// Returns the pose between `a` (s = 0) and `b` (s = 1): linear translation, slerp rotation.
[[nodiscard]] Pose interpolate(const Pose& a, const Pose& b, double s);

/// Covariance of T_a_c = T_a_b * T_b_c if the errors of the two motions are independent.
[[nodiscard]] Matrix6 compose_covariance(const Matrix6& covariance_ab,
                                         const Pose& T_b_c,
                                         const Matrix6& covariance_bc);

/// Rotation from the optical frame (x right, y down, z forward) to body axes (x forward, y left,
/// z up); REP-103.
[[nodiscard]] Pose T_body_optical();

/// Returns the yaw [rad] of a pose whose frames have z up.
[[nodiscard]] double yaw_rad(const Pose& T);

}  // namespace surefoot
