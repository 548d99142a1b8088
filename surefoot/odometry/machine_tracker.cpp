// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/machine_tracker.hpp"

#include <Eigen/Cholesky>

namespace surefoot::odometry {
namespace {

/// 99.9 % quantile of a chi-square variable with six degrees of freedom.
constexpr double kChi2Limit = 22.46;
/// This many frames in a row beyond the limit are a contradiction, not chance.
constexpr int kContradictions = 3;

bool is_usable(const MachineMotion& motion) {
    return motion.T_previous_body.all_finite() && motion.covariance.allFinite() &&
           motion.covariance.diagonal().minCoeff() >= 0.0;
}

}  // namespace

void MachineTracker::advance(const std::optional<MachineMotion>& motion) {
    if (!motion || !is_usable(*motion)) {
        since_place_.reset();
        return;
    }
    if (!since_place_) return;
    since_place_->covariance =
        compose_covariance(since_place_->covariance, motion->T_previous_body, motion->covariance);
    since_place_->T_previous_body = since_place_->T_previous_body * motion->T_previous_body;
}

std::optional<CameraFix> MachineTracker::reckoned() const {
    if (!placed_ || !since_place_) return std::nullopt;
    const Pose T_camera_body = T_body_camera_.inverse();
    return CameraFix{
        T_odom_camera_ * T_camera_body * since_place_->T_previous_body * T_body_camera_,
        camera_to_body_covariance(since_place_->covariance, T_camera_body)};
}

CameraFix MachineTracker::improved(const CameraFix& seen) {
    const std::optional<CameraFix> known = reckoned();
    if (!known) return seen;
    const Vector6 off = difference(seen.T_odom_camera, known->T_odom_camera);
    const auto expected = Matrix6(seen.covariance + known->covariance).ldlt();
    if (!(off.dot(expected.solve(off)) <= kChi2Limit)) {  // true for NaN
        ++contradictions_;
        return seen;
    }
    contradictions_ = 0;
    const Matrix6 gain = expected.solve(seen.covariance).transpose();
    const Matrix6 covariance = (Matrix6::Identity() - gain) * seen.covariance;
    return {perturbed(seen.T_odom_camera, gain * off), 0.5 * (covariance + covariance.transpose())};
}

void MachineTracker::place(const Pose& T_odom_camera) {
    T_odom_camera_ = T_odom_camera;
    since_place_ = MachineMotion{};
    placed_ = true;
}

bool MachineTracker::disagrees() const noexcept {
    return contradictions_ >= kContradictions;
}

}  // namespace surefoot::odometry
