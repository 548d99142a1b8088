// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/mount_monitor.hpp"

#include <algorithm>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::pipeline {
namespace {

/// Largest motion between two frames that counts as standing. It is above the noise of the odometry
/// and below any sway.
constexpr double kStanding_m = 1e-3;
constexpr double kStanding_rad = 5e-4;
/// Shortest upright time that ends a lean. A sway passes the upright attitude in less time; a pause
/// between two steps takes longer.
constexpr double kHome_s = 1.0;
/// Shortest lean above `max_sway_deg` that counts as a moved mount. It is longer than the vibration
/// after a foot strike.
constexpr double kSway_s = 0.5;

bool stands(const MotionEstimate& motion) {
    return motion.T_previous_body.translation_m.norm() <= kStanding_m &&
           2.0 * motion.T_previous_body.rotation.vec().norm() <= kStanding_rad;
}

}  // namespace

void MountMonitor::compare(const Pose& T_odom_body, const Eigen::Vector3d& normal_body) {
    const Eigen::Vector3d by_odom =
        T_odom_body.rotation.conjugate() * Eigen::Vector3d::UnitZ() - up_body_;
    const Eigen::Vector3d by_ground = normal_body - normal_body_;
    const bool same = (by_odom - by_ground).norm() <= config_.max_lean_deg * kRadPerDeg;
    lean_rad_ = same ? std::min(by_odom.norm(), by_ground.norm()) : 0.0;
    // The plane of one frame is uncertain by about 0.1 deg. So the plane needs to show only half of
    // the lean in odom, along the direction of this lean.
    leans_ = by_odom.norm() > config_.max_lean_before_step_deg * kRadPerDeg &&
             by_ground.dot(by_odom) > 0.5 * by_odom.squaredNorm();
}

void MountMonitor::add(const MotionEstimate& motion, const GroundObservation& ground_body) {
    const double since_s = last_ns_ ? seconds_from_ns(motion.time_ns - *last_ns_) : 0.0;
    last_ns_ = motion.time_ns;
    if (motion.health != Health::ok || !ground_body.accepted) {
        upright_s_ = leaning_s_ = swaying_s_ = 0.0;
        return;
    }
    if (!started_) {
        started_ = true;
        up_body_ = motion.T_odom_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
        normal_body_ = ground_body.normal;
    }
    compare(motion.T_odom_body, ground_body.normal);
    const bool leans = lean_rad_ > config_.max_lean_deg * kRadPerDeg;
    upright_s_ = leans ? 0.0 : upright_s_ + since_s;
    leaning_s_ = leans && stands(motion) ? leaning_s_ + since_s : 0.0;
    swaying_s_ = lean_rad_ > config_.max_sway_deg * kRadPerDeg ? swaying_s_ + since_s : 0.0;
    if (leans) away_s_ += since_s;
    if (upright_s_ >= kHome_s) away_s_ = 0.0;
    moved_ = moved_ || swaying_s_ >= kSway_s || leaning_s_ >= config_.max_lean_still_s ||
             away_s_ >= config_.max_lean_walking_s;
}

}  // namespace surefoot::pipeline
