// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/tilt_drift_correction.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::pipeline {
namespace {

/// Largest weight of an observation. The weight is the time since the previous observation. With
/// this limit, the first observation after a pause does not outweigh all others.
constexpr double kLongest_s = 1.0;

}  // namespace

void LevelConfig::describe(ConfigVisitor& visitor) {
    visitor.boolean(
        "enabled", enabled, "true: correct poses whose tilt has drifted from the vertical");
    visitor.number(
        "slew_deg_s", slew_deg_s, 0.0, 0.05, "largest rate of the tilt drift correction");
    visitor.number("max_tilt_deg",
                   max_tilt_deg,
                   0.1,
                   5.0,
                   "largest tilt of ground that is used for the tilt drift correction; steeper "
                   "ground counts as a slope");
    visitor.number(
        "ignored_deg", ignored_deg, 0.0, 5.0, "a mean tilt up to this value is not corrected");
    visitor.number("average_s", average_s, 1.0, 600.0, "time over which the tilt is averaged");
    visitor.number("agreeing_share",
                   agreeing_share,
                   0.0,
                   1.0,
                   "smallest share of nearly level ground observations that a correction needs");
}

void TiltDriftCorrection::start_at(const Pose& T_odom_body, double ground_lean_rad) {
    const bool is_level = ground_lean_rad <= config_.ignored_deg * kRadPerDeg;
    *this = TiltDriftCorrection(config_);
    is_floor_level_ = is_level;
    T_odom_body_ = T_odom_body;
}

MotionEstimate TiltDriftCorrection::level(const MotionEstimate& motion) {
    if (!config_.enabled) return motion;
    const double dt_s = time_ns_ == 0 ? 0.0 : seconds_from_ns(motion.time_ns - time_ns_);
    time_ns_ = motion.time_ns;
    health_ = motion.health;
    MotionEstimate leveled = motion;
    leveled.T_odom_body = T_odom_body_ * motion.T_previous_body;
    if (const auto leaning = lean(); leaning && dt_s > 0.0) {
        const double beyond_rad = leaning->norm() - config_.ignored_deg * kRadPerDeg;
        const double turn_rad = std::clamp(
            beyond_rad, 0.0, config_.slew_deg_s * kRadPerDeg * std::min(dt_s, kLongest_s));
        // Turns the mean normal towards z.
        const Eigen::Vector2d back = -turn_rad * leaning->normalized();
        const Eigen::Vector3d turn(-back.y(), back.x(), 0.0);
        leveled.T_odom_body.rotation = (exp_so3(turn) * leveled.T_odom_body.rotation).normalized();
        lean_ += back;
        leveled.T_previous_body = T_odom_body_.inverse() * leveled.T_odom_body;
    }
    T_odom_body_ = leveled.T_odom_body;
    return leveled;
}

void TiltDriftCorrection::see(const GroundObservation& ground_body) {
    if (!ground_body.accepted || health_ != Health::ok) return;
    const double dt_s =
        seen_ns_ == 0 ? 0.0 : std::min(seconds_from_ns(time_ns_ - seen_ns_), kLongest_s);
    seen_ns_ = time_ns_;
    if (!(dt_s > 0.0)) return;
    // The average starts as a mean of all observations and becomes an exponential mean.
    seen_s_ = std::min(seen_s_ + dt_s, config_.average_s);
    const double share = std::min(dt_s / seen_s_, 1.0);
    const Eigen::Vector3d normal = T_odom_body_.rotation * ground_body.normal;
    const bool level = normal.z() > std::cos(config_.max_tilt_deg * kRadPerDeg);
    level_share_ += share * ((level ? 1.0 : 0.0) - level_share_);
    if (level) lean_ += share * (normal.head<2>() - lean_);
}

std::optional<Eigen::Vector2d> TiltDriftCorrection::lean() const {
    if (!is_floor_level_ || seen_s_ < config_.average_s || level_share_ < config_.agreeing_share)
        return std::nullopt;
    return lean_;
}

}  // namespace surefoot::pipeline
