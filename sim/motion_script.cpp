// SPDX-License-Identifier: Apache-2.0
#include "sim/motion_script.hpp"

#include <numbers>

#include "sim/rigs.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::sim {
namespace {

/// Moves all stops but the first by about a centimetre and a third of a degree.
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

}  // namespace

Result<ScriptedMotion> make_motion(const MotionScript& script, std::uint64_t seed) {
    if (script.waypoints.empty()) return usage_error("simulator: a motion has no waypoint");
    std::vector<Waypoint> stops = script.waypoints;
    vary(stops, seed);
    TrolleyConfig config;
    config.height_m = kBodyHeight_m;
    if (script.speed_m_s > 0.0) config.speed_m_s = script.speed_m_s;
    return ScriptedMotion{std::make_shared<TrolleyMotion>(TrolleyMotion::trolley(stops, config)),
                          {}};
}

}  // namespace surefoot::sim
