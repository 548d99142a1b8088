// SPDX-License-Identifier: Apache-2.0
#include "lab/imu_fusion/velocity_fusion.hpp"

#include <Eigen/LU>

#include "surefoot/core/time.hpp"

namespace surefoot::experiments {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kStartSpeed_m_s = 0.05;  ///< sigma of the first speed, as in the library

struct Velocity {
    Vector3d value;
    Matrix3d covariance;
};

Velocity weighted_mean(const Velocity& a, const Velocity& b) {
    const Matrix3d share = a.covariance * (a.covariance + b.covariance).inverse();
    return {a.value + share * (b.value - a.value), (Matrix3d::Identity() - share) * a.covariance};
}

}  // namespace

VelocityFusion::VelocityFusion(const odometry::InertialConfig& imu) : config_(imu) {}

MotionEstimate VelocityFusion::update(const MotionEstimate& vision,
                                      std::span<const ImuSample> samples) {
    samples_.insert(samples_.end(), samples.begin(), samples.end());
    odometry::Preintegration step;
    if (time_ns_)
        step = odometry::preintegrate(config_.limits,
                                      config_.noise,
                                      samples_,
                                      *time_ns_,
                                      vision.time_ns,
                                      bias_.value_or(odometry::ImuBias{}));
    const bool heard = step.problem == odometry::ImuProblem::none;
    MotionEstimate estimate = vision;
    if (bias_ && heard) {
        estimate = fused(vision, step.motion);
    } else {
        if (time_ns_) estimate.T_odom_body = T_odom_body_ * vision.T_previous_body;
        T_odom_body_ = estimate.T_odom_body;
        if (!bias_) start(vision, step);
    }
    time_ns_ = vision.time_ns;
    // Keeps the last sample before the frame, because the next interval starts with it.
    while (samples_.size() > 1 && samples_[1].time_ns <= vision.time_ns)
        samples_.erase(samples_.begin());
    return estimate;
}

void VelocityFusion::start(const MotionEstimate& vision, const odometry::Preintegration& step) {
    const bool heard = step.problem == odometry::ImuProblem::none;
    if (!heard || vision.health == Health::lost) seen_.clear();
    seen_.push_back({vision.T_odom_body, heard ? step.motion : odometry::ImuMotion{}});
    double time_s = 0.0;
    for (std::size_t i = 1; i < seen_.size(); ++i) time_s += seen_[i].motion.dt_s;
    if (time_s < config_.start_s) return;
    const auto found = odometry::start_inertial(seen_);
    seen_.clear();
    if (!found) return;
    bias_ = found->state.bias;
    velocity_odom_m_s_ = found->state.velocity_m_s;
    velocity_covariance_ = kStartSpeed_m_s * kStartSpeed_m_s * Matrix3d::Identity();
    gravity_odom_m_s2_ = -config_.gravity_m_s2 * found->state.up_odom();
}

MotionEstimate VelocityFusion::fused(const MotionEstimate& vision, const odometry::ImuMotion& imu) {
    const double dt_s = imu.dt_s;
    const double dt2_s2 = dt_s * dt_s;
    const Matrix3d R = T_odom_body_.R();
    const double gyro_var = config_.gyro_bias_sigma_rad_s * config_.gyro_bias_sigma_rad_s;
    const double accel_var = config_.accel_bias_sigma_m_s2 * config_.accel_bias_sigma_m_s2;

    // Mean velocities over the interval, in the axes of base_link at the begin of the interval.
    const Velocity turn_imu{
        log_so3(imu.rotation) / dt_s,
        imu.covariance.topLeftCorner<3, 3>() / dt2_s2 + gyro_var * Matrix3d::Identity()};
    const Velocity speed_imu{
        R.transpose() * (velocity_odom_m_s_ + 0.5 * dt_s * gravity_odom_m_s2_) +
            imu.position_m / dt_s,
        R.transpose() * velocity_covariance_ * R +
            imu.covariance.bottomRightCorner<3, 3>() / dt2_s2 +
            0.25 * dt2_s2 * accel_var * Matrix3d::Identity()};
    Velocity turn = turn_imu;
    Velocity speed = speed_imu;
    if (vision.health != Health::lost) {
        const Matrix3d R_before_now = vision.T_previous_body.R();
        const Matrix6& covariance = vision.relative_covariance;
        turn = weighted_mean(turn_imu,
                             {log_so3(vision.T_previous_body.rotation) / dt_s,
                              covariance.bottomRightCorner<3, 3>() / dt2_s2});
        speed = weighted_mean(
            speed_imu,
            {vision.T_previous_body.translation_m / dt_s,
             R_before_now * covariance.topLeftCorner<3, 3>() * R_before_now.transpose() / dt2_s2});
    }

    // Speed at the end of the interval: the prediction of the IMU plus the correction of the mean
    // speed.
    velocity_odom_m_s_ +=
        dt_s * gravity_odom_m_s2_ + R * imu.velocity_m_s + R * (speed.value - speed_imu.value);
    velocity_covariance_ = R *
                           (speed.covariance + imu.covariance.block<3, 3>(3, 3) +
                            dt2_s2 * accel_var * Matrix3d::Identity()) *
                           R.transpose();
    MotionEstimate estimate = vision;
    estimate.T_previous_body = {exp_so3(dt_s * turn.value), dt_s * speed.value};
    const Matrix3d R_now_before = estimate.T_previous_body.R().transpose();
    estimate.relative_covariance.setZero();
    estimate.relative_covariance.topLeftCorner<3, 3>() =
        dt2_s2 * R_now_before * speed.covariance * R_now_before.transpose();
    estimate.relative_covariance.bottomRightCorner<3, 3>() = dt2_s2 * turn.covariance;
    T_odom_body_ = T_odom_body_ * estimate.T_previous_body;
    estimate.T_odom_body = T_odom_body_;
    return estimate;
}

}  // namespace surefoot::experiments
