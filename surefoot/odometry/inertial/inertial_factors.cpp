// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/inertial/inertial_factors.hpp"

#include <algorithm>

namespace surefoot::odometry::inertial {
namespace {

/// Derivative of up_odom by the tilt.
Eigen::Matrix<double, 3, 2> up_by_tilt(const InertialState& state) {
    const Eigen::Vector3d tilt(state.tilt_rad.x(), state.tilt_rad.y(), 0.0);
    const Eigen::Matrix3d J = -(state.R_odom_level * exp_so3(tilt)).toRotationMatrix() *
                              skew(Eigen::Vector3d::UnitZ()) * right_jacobian_so3(tilt);
    return J.leftCols<2>();
}

}  // namespace

Pair moved(const Pair& pair, const VectorAll& step) {
    Vector17 previous;
    Vector17 present;
    previous << step.head<kFrame>(), step.tail<2>();
    present << step.segment<kFrame>(kPresent), step.tail<2>();
    return {perturbed(pair.previous, previous), perturbed(pair.present, present)};
}

void add_prior(const InertialState& mean, const Matrix17& information, const Pair& at, Normal& n) {
    const Vector17 error = difference(mean, at.previous);
    Eigen::Matrix<double, kInertialSize, kAll> J =
        Eigen::Matrix<double, kInertialSize, kAll>::Zero();
    J.topLeftCorner<kFrame, kFrame>().setIdentity();
    J.bottomRightCorner<2, 2>().setIdentity();
    J.topLeftCorner<3, 3>() =
        (mean.T_odom_imu.rotation.conjugate() * at.previous.T_odom_imu.rotation).toRotationMatrix();
    J.block<3, 3>(3, 3) = inverse_right_jacobian_so3(error.segment<3>(3));
    n.add<kInertialSize>(error, J, information);
}

void MotionFactor::add_to(const Pair& at, Normal& n) const {
    const InertialState& i = at.previous;
    const InertialState& j = at.present;
    const double dt = motion.dt_s;
    const Eigen::Matrix3d R_i_odom = i.T_odom_imu.R().transpose();
    const Eigen::Matrix3d R_i_j = R_i_odom * j.T_odom_imu.R();
    const Eigen::Vector3d lift = gravity_m_s2 * i.up_odom();  // minus gravity
    // Forster et al. 2017, (45)
    const Eigen::Vector3d turn = log_so3(motion.rotation_at(i.bias).conjugate() *
                                         i.T_odom_imu.rotation.conjugate() * j.T_odom_imu.rotation);
    const Eigen::Vector3d gain = R_i_odom * (j.velocity_m_s - i.velocity_m_s + dt * lift);
    const Eigen::Vector3d path =
        R_i_odom * (j.T_odom_imu.translation_m - i.T_odom_imu.translation_m - dt * i.velocity_m_s +
                    0.5 * dt * dt * lift);
    Vector9 residual;
    residual << turn, gain - motion.velocity_at(i.bias), path - motion.position_at(i.bias);

    Eigen::Matrix<double, 9, kAll> J = Eigen::Matrix<double, 9, kAll>::Zero();
    const Eigen::Matrix3d by_turn = inverse_right_jacobian_so3(turn);
    J.block<3, 3>(0, 3) = -by_turn * R_i_j.transpose();
    J.block<3, 3>(0, kPresent + 3) = by_turn;
    const Eigen::Vector3d corrected =
        motion.d_rotation_d_gyro * (i.bias.gyro_rad_s - motion.bias.gyro_rad_s);
    J.block<3, 3>(0, kGyroBiasAt) = -by_turn * exp_so3(turn).toRotationMatrix().transpose() *
                                    right_jacobian_so3(corrected) * motion.d_rotation_d_gyro;
    const Eigen::Matrix<double, 3, 2> by_tilt = gravity_m_s2 * R_i_odom * up_by_tilt(i);
    J.block<3, 3>(3, 3) = skew(gain);
    J.block<3, 3>(3, kVelocityAt) = -R_i_odom;
    J.block<3, 3>(3, kPresent + kVelocityAt) = R_i_odom;
    J.block<3, 3>(3, kGyroBiasAt) = -motion.d_velocity_d_gyro;
    J.block<3, 3>(3, kAccelBiasAt) = -motion.d_velocity_d_accel;
    J.block<3, 2>(3, kSharedTilt) = dt * by_tilt;
    J.block<3, 3>(6, 0) = -Eigen::Matrix3d::Identity();
    J.block<3, 3>(6, 3) = skew(path);
    J.block<3, 3>(6, kPresent) = R_i_j;
    J.block<3, 3>(6, kVelocityAt) = -dt * R_i_odom;
    J.block<3, 3>(6, kGyroBiasAt) = -motion.d_position_d_gyro;
    J.block<3, 3>(6, kAccelBiasAt) = -motion.d_position_d_accel;
    J.block<3, 2>(6, kSharedTilt) = 0.5 * dt * dt * by_tilt;
    n.add<9>(residual, J, information);
    add_bias_walk(at, n);
}

void MotionFactor::add_bias_walk(const Pair& at, Normal& n) const {
    Vector6 walk;
    walk << at.present.bias.gyro_rad_s - at.previous.bias.gyro_rad_s,
        at.present.bias.accel_m_s2 - at.previous.bias.accel_m_s2;
    for (int k = 0; k < 6; ++k) {
        const int before = kGyroBiasAt + k;
        const int after = kPresent + before;
        const double weight = bias_information[k];
        n.H(before, before) += weight;
        n.H(after, after) += weight;
        n.H(before, after) -= weight;
        n.H(after, before) -= weight;
        n.b[before] += weight * walk[k];
        n.b[after] -= weight * walk[k];
        n.cost += weight * walk[k] * walk[k];
    }
}

void PointsFactor::add_to(const Pair& at, Normal& n) {
    const Pose T_odom_camera = at.present.T_odom_imu * T_imu_camera;
    const VisualNormalEquations v = visual_normal_equations(
        seen.rig, seen.config, seen.matches, T_odom_camera, seen.config.gate_sigmas, inlier);
    const double weight = 1.0 / (seen.residual_scale * seen.residual_scale);
    const Matrix6 J_weighted = weight * camera_by_imu.transpose();
    n.H.block<6, 6>(kPresent, kPresent).noalias() += J_weighted * v.H * camera_by_imu;
    n.b.segment<6>(kPresent).noalias() += J_weighted * v.b;
    n.cost += weight * v.cost;
    inliers = v.inliers;
    residual_px = std::sqrt(v.square_px / (2.0 * std::max(v.inliers, 1)));
}

void PoseFactor::add_to(const Pair& at, Normal& n) const {
    const Vector6 error = difference(known.T_odom_imu, at.present.T_odom_imu);
    Eigen::Matrix<double, 6, kAll> J = Eigen::Matrix<double, 6, kAll>::Zero();
    J.block<3, 3>(0, kPresent) =
        (known.T_odom_imu.rotation.conjugate() * at.present.T_odom_imu.rotation).toRotationMatrix();
    J.block<3, 3>(3, kPresent + 3) = inverse_right_jacobian_so3(error.tail<3>());
    n.add<6>(error, J, information);
    if (!known.standing_sigma_m_s) return;
    const double weight = 1.0 / (*known.standing_sigma_m_s * *known.standing_sigma_m_s);
    const Eigen::Vector3d& velocity = at.present.velocity_m_s;
    constexpr int kAt = kPresent + kVelocityAt;
    n.H.diagonal().segment<3>(kAt).array() += weight;
    n.b.segment<3>(kAt) -= weight * velocity;
    n.cost += weight * velocity.squaredNorm();
}

}  // namespace surefoot::odometry::inertial
