// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/inertial/inertial_start.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace surefoot::odometry {
namespace {

constexpr std::size_t kMinFrames = 4;
constexpr double kMinGravity_m_s2 = 1.0;

/// Rotation error of the gyroscope from one frame to the next [rad]: vision minus IMU.
Eigen::Vector3d missing_turn(const SeenMotion& from, const SeenMotion& to, const ImuBias& bias) {
    return log_so3(to.motion.rotation_at(bias).conjugate() * from.T_odom_imu.rotation.conjugate() *
                   to.T_odom_imu.rotation);
}

void find_gyro_bias(std::span<const SeenMotion> frames, InertialStart& start) {
    // Two rounds, because the correction is of first order in the bias.
    for (int round = 0; round < 2; ++round) {
        Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
        Eigen::Vector3d b = Eigen::Vector3d::Zero();
        for (std::size_t k = 1; k < frames.size(); ++k) {
            const Eigen::Matrix3d& J = frames[k].motion.d_rotation_d_gyro;
            H += J.transpose() * J;
            b += J.transpose() * missing_turn(frames[k - 1], frames[k], start.state.bias);
        }
        start.state.bias.gyro_rad_s += H.ldlt().solve(b);
    }
    double squares = 0.0;
    for (std::size_t k = 1; k < frames.size(); ++k)
        squares += missing_turn(frames[k - 1], frames[k], start.state.bias).squaredNorm();
    start.residual_rad = std::sqrt(squares / static_cast<double>(frames.size() - 1));
}

/// Sum of the IMU's readings along the frames, without gravity and without a velocity at the first
/// frame.
struct Sum {
    double time_s = 0.0;
    Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();

    void add(const Pose& T_odom_before, const ImuMotion& motion, const ImuBias& bias) {
        position_m +=
            motion.dt_s * velocity_m_s + T_odom_before.rotation * motion.position_at(bias);
        velocity_m_s += T_odom_before.rotation * motion.velocity_at(bias);
        time_s += motion.dt_s;
    }
};

}  // namespace

std::optional<InertialStart> start_inertial(std::span<const SeenMotion> frames) {
    if (frames.size() < kMinFrames) return std::nullopt;
    InertialStart start;
    find_gyro_bias(frames, start);

    // Unknowns per axis: p_0, v_0 and g. The design matrix is the same for all three axes.
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d b = Eigen::Matrix3d::Zero();
    const auto row = [](double t) { return Eigen::Vector3d(1.0, t, 0.5 * t * t); };
    Sum sum;
    for (std::size_t k = 0; k < frames.size(); ++k) {
        if (k > 0) sum.add(frames[k - 1].T_odom_imu, frames[k].motion, start.state.bias);
        const Eigen::Vector3d a = row(sum.time_s);
        H += a * a.transpose();
        b += a * (frames[k].T_odom_imu.translation_m - sum.position_m).transpose();
    }
    const Eigen::Matrix3d unknown = H.ldlt().solve(b);  // rows: p_0, v_0, g
    const Eigen::Vector3d gravity = unknown.row(2).transpose();
    start.gravity_m_s2 = gravity.norm();
    if (!(start.gravity_m_s2 >= kMinGravity_m_s2) || !unknown.allFinite() ||
        !start.state.bias.gyro_rad_s.allFinite())
        return std::nullopt;
    start.state.T_odom_imu = frames.back().T_odom_imu;
    start.state.velocity_m_s = unknown.row(1).transpose() + sum.time_s * gravity + sum.velocity_m_s;
    start.state.R_odom_level =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), -gravity).normalized();
    double squares = 0.0;
    sum = {};
    for (std::size_t k = 0; k < frames.size(); ++k) {
        if (k > 0) sum.add(frames[k - 1].T_odom_imu, frames[k].motion, start.state.bias);
        squares += (frames[k].T_odom_imu.translation_m - sum.position_m -
                    unknown.transpose() * row(sum.time_s))
                       .squaredNorm();
    }
    start.residual_m = std::sqrt(squares / static_cast<double>(frames.size()));
    return start;
}

}  // namespace surefoot::odometry
