// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/motion/trolley_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surefoot/core/assert.hpp"
#include "surefoot/sim/motion/smooth_curve.hpp"

namespace surefoot::sim {
namespace {

/// Distance along the path with its derivatives by time.
struct Progress {
    double way_m = 0.0;
    double speed_m_s = 0.0;
    double acceleration_m_s2 = 0.0;
};

/// Acceleration from rest: v = V (3u^2 - 2u^3), u = t / T. The distance after T is V T / 2.
Progress speeding_up(double speed_m_s, double ramp_s, double t_s) {
    const double u = t_s / ramp_s;
    return {speed_m_s * ramp_s * u * u * u * (1.0 - 0.5 * u),
            speed_m_s * u * u * (3.0 - 2.0 * u),
            speed_m_s / ramp_s * 6.0 * u * (1.0 - u)};
}

Progress progress(double length_m, double speed_m_s, double ramp_s, double duration_s, double t_s) {
    if (t_s < ramp_s) return speeding_up(speed_m_s, ramp_s, t_s);
    if (t_s < duration_s - ramp_s) return {speed_m_s * (t_s - 0.5 * ramp_s), speed_m_s, 0.0};
    const Progress mirrored = speeding_up(speed_m_s, ramp_s, duration_s - t_s);
    return {length_m - mirrored.way_m, mirrored.speed_m_s, -mirrored.acceleration_m_s2};
}

/// Height gain and slope after some distance on a ramp. The slope has its derivatives by distance.
struct Ramp {
    double rise_m = 0.0;
    Jet slope;
};

/// The slope grows as 6u^5 - 15u^4 + 10u^3 over `blend_m` and then stays constant. `ramp` mirrors
/// this function for the second half of the path.
Ramp starting_ramp(double steepest, double blend_m, double way_m) {
    const double u = std::min(way_m / blend_m, 1.0);
    const double rest_m = way_m - u * blend_m;
    const double v = 1.0 - u;
    return {steepest * (blend_m * u * u * u * u * (2.5 + u * (u - 3.0)) + rest_m),
            {steepest * eased(u),
             steepest / blend_m * 30.0 * u * u * v * v,
             steepest / (blend_m * blend_m) * 60.0 * u * v * (v - u)}};
}

Ramp ramp(double length_m, double rise_m, double way_m) {
    constexpr double kBlend_m = 0.3;
    const double blend_m = std::min(kBlend_m, 0.5 * length_m);
    const double steepest = rise_m / (length_m - blend_m);
    if (way_m <= 0.5 * length_m) return starting_ramp(steepest, blend_m, way_m);
    const Ramp mirrored = starting_ramp(steepest, blend_m, length_m - way_m);
    return {rise_m - mirrored.rise_m,
            {mirrored.slope.value, -mirrored.slope.rate, mirrored.slope.acceleration}};
}

/// Converts a function of distance to a function of time.
Jet in_time(const Jet& by_way, const Jet& way) {
    return {by_way.value,
            by_way.rate * way.rate,
            by_way.acceleration * way.rate * way.rate + by_way.rate * way.acceleration};
}

Jet cosine(const Jet& angle, double offset_rad) {
    const double c = std::cos(angle.value + offset_rad);
    const double s = std::sin(angle.value + offset_rad);
    return {c, -s * angle.rate, -c * angle.rate * angle.rate - s * angle.acceleration};
}

Jet arc_tangent(const Jet& x) {
    const double by_x = 1.0 / (1.0 + x.value * x.value);
    return {std::atan(x.value),
            by_x * x.rate,
            by_x * x.acceleration - 2.0 * x.value * by_x * by_x * x.rate * x.rate};
}

}  // namespace

TrolleyMotion TrolleyMotion::trolley(const std::vector<Waypoint>& waypoints,
                                     const TrolleyConfig& config) {
    SUREFOOT_ASSERT(!waypoints.empty());
    TrolleyMotion motion;
    motion.height_m_ = config.height_m;
    motion.append_pause(waypoints.front());
    for (std::size_t i = 1; i < waypoints.size(); ++i) {
        motion.append_way(waypoints[i - 1], waypoints[i], config);
        motion.append_pause(waypoints[i]);
    }
    return motion;
}

TrolleyMotion TrolleyMotion::stand(const Waypoint& place, double height_m, double duration_s) {
    TrolleyMotion motion;
    motion.height_m_ = height_m;
    Waypoint standing = place;
    standing.pause_s = duration_s;
    motion.append_pause(standing);
    return motion;
}

void TrolleyMotion::append_pause(const Waypoint& place) {
    Segment segment;
    segment.start_s = duration_s_;
    segment.duration_s = place.pause_s;
    segment.from = place;
    segment.to = place;
    segments_.push_back(segment);
    duration_s_ += segment.duration_s;
}

void TrolleyMotion::append_way(const Waypoint& from,
                               const Waypoint& to,
                               const TrolleyConfig& config) {
    Segment segment;
    segment.length_m = std::max(std::hypot(to.x_m - from.x_m, to.y_m - from.y_m),
                                config.turn_lever_m * std::abs(to.yaw_rad - from.yaw_rad));
    if (segment.length_m == 0.0) return;
    segment.start_s = duration_s_;
    // On a short path the trolley never reaches full speed: it only accelerates and brakes.
    segment.ramp_s = config.ramp_s;
    segment.speed_m_s = std::min(config.speed_m_s, segment.length_m / config.ramp_s);
    segment.duration_s = segment.length_m / segment.speed_m_s + config.ramp_s;
    segment.tilts = config.tilts;
    segment.from = from;
    segment.to = to;
    segments_.push_back(segment);
    duration_s_ += segment.duration_s;
}

std::vector<double> TrolleyMotion::pauses_s() const {
    std::vector<double> starts_s;
    starts_s.reserve(segments_.size());
    for (const Segment& segment : segments_) {
        if (segment.length_m == 0.0 && segment.duration_s > 0.0)
            starts_s.push_back(segment.start_s);
    }
    return starts_s;
}

MotionState TrolleyMotion::at(double time_s) const {
    const double t_s = std::clamp(time_s, 0.0, duration_s_);
    const auto next = std::upper_bound(
        segments_.begin(), segments_.end(), t_s, [](double t, const Segment& segment) {
            return t < segment.start_s;
        });
    const Segment& segment = *(next - 1);
    Progress now;
    double scale = 0.0;
    if (segment.length_m > 0.0) {
        const double in_segment_s = std::min(t_s - segment.start_s, segment.duration_s);
        now = progress(
            segment.length_m, segment.speed_m_s, segment.ramp_s, segment.duration_s, in_segment_s);
        scale = 1.0 / segment.length_m;
    }
    const Eigen::Vector3d way_m(
        segment.to.x_m - segment.from.x_m, segment.to.y_m - segment.from.y_m, 0.0);
    const double turn_rad = segment.to.yaw_rad - segment.from.yaw_rad;
    const double share = scale * now.way_m;

    MotionState state;
    state.T_world_body.translation_m =
        Eigen::Vector3d(segment.from.x_m, segment.from.y_m, height_m_ + segment.from.ground_z_m) +
        share * way_m;
    const double half_yaw_rad = 0.5 * (segment.from.yaw_rad + share * turn_rad);
    state.T_world_body.rotation =
        Eigen::Quaterniond(std::cos(half_yaw_rad), 0.0, 0.0, std::sin(half_yaw_rad));
    state.velocity_world_m_s = scale * now.speed_m_s * way_m;
    state.acceleration_world_m_s2 = scale * now.acceleration_m_s2 * way_m;
    state.angular_velocity_body_rad_s.z() = scale * now.speed_m_s * turn_rad;
    state.angular_acceleration_body_rad_s2.z() = scale * now.acceleration_m_s2 * turn_rad;
    const double rise_m = segment.to.ground_z_m - segment.from.ground_z_m;
    if (rise_m == 0.0 || way_m.norm() == 0.0) return state;

    const double length_m = way_m.norm();
    const Jet part{share, scale * now.speed_m_s, scale * now.acceleration_m_s2};
    const Jet way = length_m * part;
    const Ramp here = ramp(length_m, rise_m, way.value);
    const Jet slope = in_time(here.slope, way);
    const Jet height{height_m_ + segment.from.ground_z_m + here.rise_m,
                     here.slope.value * way.rate,
                     here.slope.rate * way.rate * way.rate + here.slope.value * way.acceleration};
    const Jet yaw = Jet{segment.from.yaw_rad, 0.0, 0.0} + turn_rad * part;
    // The slope along a body axis is the slope of the path times the cosine of the angle between
    // this axis and the direction of travel.
    const double direction_rad = std::atan2(way_m.y(), way_m.x());
    const Jet ahead = slope * cosine(yaw, -direction_rad);
    const Jet left = slope * cosine(yaw, 0.5 * std::numbers::pi - direction_rad);
    const double tilts = segment.tilts ? 1.0 : 0.0;
    return motion_state({Jet{segment.from.x_m, 0.0, 0.0} + way_m.x() * part,
                         Jet{segment.from.y_m, 0.0, 0.0} + way_m.y() * part,
                         height},
                        {tilts * arc_tangent(left), -tilts * arc_tangent(ahead), yaw});
}

}  // namespace surefoot::sim
