// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/motion/motion_script.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "surefoot/core/rng.hpp"
#include "surefoot/sim/motion/hand_motion.hpp"
#include "surefoot/sim/motion/rex_gait.hpp"
#include "surefoot/sim/motion/rex_plan.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

namespace surefoot::sim {
namespace {

struct Limits {
    double slowest_m_s;
    double fastest_m_s;
};
/// Speed limits of the motion models trolley, rex and hand. The REX takes 4 to 20 s per step;
/// trolley and hand-held camera go up to a brisk walk.
constexpr Limits kSpeeds[] = {{0.01, 2.0}, {0.02, 0.10}, {0.2, 2.0}};
constexpr double kFarthest_m = 1000.0;
constexpr double kLongestPause_s = 3600.0;
/// Steepest slope between two waypoints for trolley, rex (not used) and hand. A trolley takes a
/// ramp; a person with a hand-held camera climbs stairs.
constexpr double kSteepest[] = {0.5, 0.0, 1.0};
constexpr double kLowestHand_m = 0.5;
constexpr double kHighestHand_m = 2.2;

/// Moves all stops but the first by up to 1 cm along x and y, and turns them by up to 0.3 deg.
void vary(std::vector<Waypoint>& stops, std::uint64_t seed) {
    constexpr std::uint64_t kPathStream = 0x70617468;
    constexpr double kTurn_rad = 0.3 * std::numbers::pi / 180.0;
    Rng rng(mix_seed(seed, kPathStream));
    for (std::size_t i = 1; i < stops.size(); ++i) {
        stops[i].x_m += rng.uniform(-0.01, 0.01);
        stops[i].y_m += rng.uniform(-0.01, 0.01);
        stops[i].yaw_rad += rng.uniform(-kTurn_rad, kTurn_rad);
    }
}

/// Height of the path through the waypoints, at the point of the path nearest to (x, y).
double way_height_m(const std::vector<Waypoint>& stops, double x_m, double y_m) {
    double nearest_sq = std::numeric_limits<double>::infinity();
    double z_m = stops.front().ground_z_m;
    for (std::size_t i = 0; i < stops.size(); ++i) {
        const Waypoint& a = stops[i == 0 ? 0 : i - 1];
        const Waypoint& b = stops[i];
        const double dx = b.x_m - a.x_m;
        const double dy = b.y_m - a.y_m;
        const double length_sq = dx * dx + dy * dy;
        const double along =
            length_sq == 0.0
                ? 1.0
                : std::clamp(((x_m - a.x_m) * dx + (y_m - a.y_m) * dy) / length_sq, 0.0, 1.0);
        const double off_x = x_m - a.x_m - along * dx;
        const double off_y = y_m - a.y_m - along * dy;
        const double distance_sq = off_x * off_x + off_y * off_y;
        if (distance_sq >= nearest_sq) continue;
        nearest_sq = distance_sq;
        z_m = a.ground_z_m + along * (b.ground_z_m - a.ground_z_m);
    }
    return z_m;
}

Status check_waypoint(std::size_t i, const Waypoint& stop) {
    const bool usable = std::abs(stop.x_m) <= kFarthest_m && std::abs(stop.y_m) <= kFarthest_m &&
                        std::abs(stop.ground_z_m) <= kFarthest_m &&
                        std::abs(stop.yaw_rad) <= kFarthest_m;  // also false for NaN
    if (!usable) {
        return usage_error(
            fmt::format("simulator: waypoint {} is at x {} y {} z {} yaw {} rad; give finite "
                        "numbers with a magnitude up to {:.0f}",
                        i,
                        stop.x_m,
                        stop.y_m,
                        stop.ground_z_m,
                        stop.yaw_rad,
                        kFarthest_m));
    }
    if (!(stop.pause_s >= 0.0 && stop.pause_s <= kLongestPause_s)) {
        return usage_error(fmt::format("simulator: waypoint {} has pause_s {}; it must be 0 to {}",
                                       i,
                                       stop.pause_s,
                                       kLongestPause_s));
    }
    return {};
}

Status check_slope(MotionModel motion_model,
                   std::size_t i,
                   const Waypoint& from,
                   const Waypoint& to) {
    const double rise_m = to.ground_z_m - from.ground_z_m;
    const double way_m = std::hypot(to.x_m - from.x_m, to.y_m - from.y_m);
    const double steepest = kSteepest[static_cast<std::size_t>(motion_model)];
    if (std::abs(rise_m) <= steepest * way_m) return {};
    return usage_error(fmt::format(
        "simulator: the way to waypoint {} rises by {:.3f} m over {:.3f} m; motion_model {} climbs "
        "1:{:.0f} at most. Put waypoints at the foot and at the top of the slope, or set "
        "motion_model to rex",
        i,
        rise_m,
        way_m,
        kMotionModelNames[static_cast<std::size_t>(motion_model)],
        1.0 / steepest));
}

Status check_height(const MotionScript& script) {
    if (script.height_m == 0.0) return {};
    if (script.motion_model != MotionModel::hand) {
        return usage_error(fmt::format(
            "simulator: height_m is allowed for motion_model hand only, because motion_model "
            "{} has a fixed height; remove height_m",
            kMotionModelNames[static_cast<std::size_t>(script.motion_model)]));
    }
    if (script.height_m >= kLowestHand_m && script.height_m <= kHighestHand_m) return {};
    return usage_error(
        fmt::format("simulator: height_m is {}; for motion_model hand it must be {} to {} m (0 = "
                    "default)",
                    script.height_m,
                    kLowestHand_m,
                    kHighestHand_m));
}

Status check(const MotionScript& script) {
    if (script.waypoints.empty())
        return usage_error("simulator: a motion has no waypoint; add at least one");
    const auto motion_model = static_cast<std::size_t>(script.motion_model);
    const Limits& speeds = kSpeeds[motion_model];
    if (script.speed_m_s != 0.0 &&
        !(script.speed_m_s >= speeds.slowest_m_s && script.speed_m_s <= speeds.fastest_m_s)) {
        return usage_error(
            fmt::format("simulator: speed_m_s is {}; motion_model {} moves at {} to {} m/s (0 = "
                        "default)",
                        script.speed_m_s,
                        kMotionModelNames[motion_model],
                        speeds.slowest_m_s,
                        speeds.fastest_m_s));
    }
    if (Status status = check_height(script); !status) return status;
    for (std::size_t i = 0; i < script.waypoints.size(); ++i) {
        if (Status status = check_waypoint(i, script.waypoints[i]); !status) return status;
        if (i == 0 || script.motion_model == MotionModel::rex) continue;
        if (Status status =
                check_slope(script.motion_model, i, script.waypoints[i - 1], script.waypoints[i]);
            !status)
            return status;
    }
    return {};
}

Result<ScriptedMotion> carried_by_rex(const std::vector<Waypoint>& stops,
                                      double speed_m_s,
                                      std::uint64_t seed,
                                      const GroundHeight& ground_z_m) {
    constexpr std::uint64_t kPlanStream = 0x706c616e;
    constexpr std::uint64_t kGaitStream = 0x67616974;
    const RexStepSizes sizes;
    Rng rng(mix_seed(seed, kPlanStream));
    const auto plan = plan_rex_steps(stops, sizes, rng);
    if (!plan) return plan.error();
    RexGaitConfig config;
    if (speed_m_s > 0.0) config.step_s = sizes.forward_m / speed_m_s;
    config.ground_under_body = !ground_z_m;
    const auto motion = RexMotion::make(
        *plan,
        config,
        ground_z_m ? ground_z_m
                   : [&stops](double x_m, double y_m) { return way_height_m(stops, x_m, y_m); },
        mix_seed(seed, kGaitStream));
    if (!motion) return motion.error();
    ScriptedMotion result;
    for (std::size_t i = 0; i < plan->steps.size(); ++i) {
        const RexMotion::Span& span = motion->steps()[i];
        result.steps.push_back({span.start_s,
                                span.end_s,
                                plan->steps[i].movement.command,
                                span.T_world_before,
                                span.T_world_after});
    }
    result.motion = std::make_shared<RexMotion>(*motion);
    return result;
}

}  // namespace

Result<ScriptedMotion> make_motion(const MotionScript& script,
                                   std::uint64_t seed,
                                   const GroundHeight& ground_z_m) {
    if (Status status = check(script); !status) return status.error();
    std::vector<Waypoint> stops = script.waypoints;
    vary(stops, seed);
    if (script.motion_model == MotionModel::rex)
        return carried_by_rex(stops, script.speed_m_s, seed, ground_z_m);
    if (script.motion_model == MotionModel::hand) {
        HandConfig config;
        if (script.speed_m_s > 0.0) config.speed_m_s = script.speed_m_s;
        if (script.height_m > 0.0) config.height_m = script.height_m;
        return ScriptedMotion{std::make_shared<HandMotion>(stops, config, seed), {}, {}};
    }
    TrolleyConfig config;
    config.height_m = kBodyHeight_m;
    if (script.speed_m_s > 0.0) config.speed_m_s = script.speed_m_s;
    ScriptedMotion result;
    const auto trolley = std::make_shared<TrolleyMotion>(TrolleyMotion::trolley(stops, config));
    for (const double start_s : trolley->pauses_s())
        result.stops.push_back({start_s, trolley->at(start_s).T_world_body});
    result.motion = trolley;
    return result;
}

}  // namespace surefoot::sim
