// SPDX-License-Identifier: Apache-2.0
#include "surefoot/core/pose.hpp"

#include <cmath>

namespace surefoot {

Pose Pose::inverse() const {
    const Eigen::Quaterniond inverse_rotation = rotation.conjugate();
    return {inverse_rotation, -(inverse_rotation * translation_m)};
}

Eigen::Matrix4d Pose::matrix() const {
    Eigen::Matrix4d M = Eigen::Matrix4d::Identity();
    M.topLeftCorner<3, 3>() = R();
    M.topRightCorner<3, 1>() = translation_m;
    return M;
}

Pose Pose::from_matrix(const Eigen::Matrix4d& T_a_b) {
    return {Eigen::Quaterniond(Eigen::Matrix3d(T_a_b.topLeftCorner<3, 3>())).normalized(),
            T_a_b.topRightCorner<3, 1>()};
}

bool Pose::all_finite() const {
    return rotation.coeffs().allFinite() && translation_m.allFinite();
}

Pose operator*(const Pose& T_a_b, const Pose& T_b_c) {
    return {(T_a_b.rotation * T_b_c.rotation).normalized(),
            T_a_b.rotation * T_b_c.translation_m + T_a_b.translation_m};
}

Eigen::Vector3d operator*(const Pose& T_a_b, const Eigen::Vector3d& p_b) {
    return T_a_b.rotation * p_b + T_a_b.translation_m;
}

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
    Eigen::Matrix3d S;
    S << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
    return S;
}

Eigen::Quaterniond exp_so3(const Eigen::Vector3d& theta_rad) {
    const double angle_rad = theta_rad.norm();
    // Below 1e-8 rad the second-order term vanishes in double precision.
    const double half_sinc = angle_rad < 1e-8 ? 0.5 : std::sin(0.5 * angle_rad) / angle_rad;
    Eigen::Quaterniond q;
    q.w() = std::cos(0.5 * angle_rad);
    q.vec() = half_sinc * theta_rad;
    return q.normalized();
}

Eigen::Vector3d log_so3(const Eigen::Quaterniond& rotation) {
    const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;  // q and -q are one rotation
    const Eigen::Vector3d v = sign * rotation.vec();
    const double sin_half = v.norm();
    const double cos_half = sign * rotation.w();
    const double scale =
        sin_half < 1e-10 ? 2.0 / cos_half : 2.0 * std::atan2(sin_half, cos_half) / sin_half;
    return scale * v;
}

Pose perturbed(const Pose& T, const Vector6& delta) {
    return {(T.rotation * exp_so3(delta.tail<3>())).normalized(),
            T.translation_m + T.rotation * Eigen::Vector3d(delta.head<3>())};
}

Vector6 difference(const Pose& from, const Pose& to) {
    Vector6 delta;
    delta.head<3>() = from.rotation.conjugate() * (to.translation_m - from.translation_m);
    delta.tail<3>() = log_so3(from.rotation.conjugate() * to.rotation);
    return delta;
}

Pose interpolate(const Pose& a, const Pose& b, double s) {
    return {a.rotation.slerp(s, b.rotation).normalized(),
            (1.0 - s) * a.translation_m + s * b.translation_m};
}

Matrix6 compose_covariance(const Matrix6& covariance_ab,
                           const Pose& T_b_c,
                           const Matrix6& covariance_bc) {
    // d(p_ac) = R_bc^T (dp_ab - [p_bc]x theta_ab) + dp_bc,  theta_ac = R_bc^T theta_ab + theta_bc
    const Eigen::Matrix3d R_c_b = T_b_c.R().transpose();
    Matrix6 J = Matrix6::Zero();
    J.topLeftCorner<3, 3>() = R_c_b;
    J.topRightCorner<3, 3>() = -R_c_b * skew(T_b_c.translation_m);
    J.bottomRightCorner<3, 3>() = R_c_b;
    return J * covariance_ab * J.transpose() + covariance_bc;
}

Pose T_body_optical() {
    Eigen::Matrix3d R_body_optical;
    R_body_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    return {Eigen::Quaterniond(R_body_optical), Eigen::Vector3d::Zero()};
}

double yaw_rad(const Pose& T) {
    const Eigen::Vector3d forward = T.rotation * Eigen::Vector3d::UnitX();
    return std::atan2(forward.y(), forward.x());
}

}  // namespace surefoot
