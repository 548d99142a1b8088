// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/motion/hand_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::sim {
namespace {

constexpr double kFade_s = 0.1;  ///< sample interval of the envelopes

TrolleyMotion way(const std::vector<Waypoint>& waypoints, const HandConfig& config) {
    TrolleyConfig trolley;
    trolley.height_m = config.height_m;
    trolley.speed_m_s = config.speed_m_s;
    trolley.ramp_s = config.ramp_s;
    trolley.tilts = false;
    return TrolleyMotion::trolley(waypoints, trolley);
}

/// Samples an envelope over the whole path; the first and the last sample are zero.
template <typename Value>
SmoothCurve envelope(const TrolleyMotion& way, Value value) {
    const int count = std::max(1, saturated_integer<int>(way.duration_s() / kFade_s) - 1);
    std::vector<double> samples(static_cast<std::size_t>(count), 0.0);
    for (int i = 1; i + 1 < count; ++i)
        samples[static_cast<std::size_t>(i)] = value((i + 1) * kFade_s);
    return {0.0, kFade_s, std::move(samples)};
}

double share_of_speed(const MotionState& state, const HandConfig& config) {
    const double speed = std::hypot(state.velocity_world_m_s.x(), state.velocity_world_m_s.y());
    return std::min(1.0, speed / config.speed_m_s);
}

Jet cosine_of(double angle_rad, double rate_rad_s, double acceleration_rad_s2) {
    const double c = std::cos(angle_rad);
    const double s = std::sin(angle_rad);
    return {c, -s * rate_rad_s, -c * rate_rad_s * rate_rad_s - s * acceleration_rad_s2};
}

}  // namespace

HandMotion::HandMotion(const std::vector<Waypoint>& waypoints,
                       const HandConfig& config,
                       std::uint64_t seed)
    : way_(way(waypoints, config)),
      walking_(envelope(way_, [&](double t_s) { return share_of_speed(way_.at(t_s), config); })),
      alive_(envelope(way_, [](double) { return 1.0; })) {
    constexpr std::uint64_t kHandStream = 0x68616e64;
    Rng rng(mix_seed(seed, kHandStream));
    const double omega_rad_s = 2.0 * std::numbers::pi * config.cadence_hz * rng.uniform(1.0, 1.1);
    const double amplitudes[kAxes] = {config.surge_m,
                                      config.sway_m,
                                      config.bob_m,
                                      config.roll_deg * kRadPerDeg,
                                      config.pitch_deg * kRadPerDeg,
                                      config.yaw_deg * kRadPerDeg};
    const bool per_step[kAxes] = {true, false, true, false, true, false};
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
        steps_[axis] = {amplitudes[axis] * rng.uniform(0.9, 1.1),
                        per_step[axis] ? omega_rad_s : 0.5 * omega_rad_s,
                        rng.uniform(0.0, 2.0 * std::numbers::pi)};
        // Two slow waves with unrelated periods, 4-9 and 10-25 s, do not repeat soon.
        const double drift = axis < 3 ? config.drift_m : config.drift_deg * kRadPerDeg;
        const double periods_s[2] = {rng.uniform(4.0, 9.0), rng.uniform(10.0, 25.0)};
        for (std::size_t i = 0; i < 2; ++i) {
            drifts_[axis][i] = {0.5 * drift * rng.uniform(0.9, 1.1),
                                2.0 * std::numbers::pi / periods_s[i],
                                rng.uniform(0.0, 2.0 * std::numbers::pi)};
        }
    }
}

MotionState HandMotion::at(double time_s) const {
    const double t_s = std::clamp(time_s, 0.0, way_.duration_s());
    const MotionState base = way_.at(t_s);
    const Jet walking = walking_.at(t_s);
    const Jet alive = alive_.at(t_s);
    std::array<Jet, kAxes> moves;
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
        moves[axis] = walking * steps_[axis].at(t_s) +
                      alive * (drifts_[axis][0].at(t_s) + drifts_[axis][1].at(t_s));
    }
    // The path is level, so its yaw turns about the z axis of the body only.
    const Jet yaw{yaw_rad(base.T_world_body),
                  base.angular_velocity_body_rad_s.z(),
                  base.angular_acceleration_body_rad_s2.z()};
    const Jet c = cosine_of(yaw.value, yaw.rate, yaw.acceleration);
    const Jet s = cosine_of(yaw.value - 0.5 * std::numbers::pi, yaw.rate, yaw.acceleration);
    const auto along = [&](int axis) {
        return Jet{base.T_world_body.translation_m[axis],
                   base.velocity_world_m_s[axis],
                   base.acceleration_world_m_s2[axis]};
    };
    return motion_state({along(0) + c * moves[0] + -1.0 * (s * moves[1]),
                         along(1) + s * moves[0] + c * moves[1],
                         along(2) + moves[2]},
                        {moves[3], moves[4], yaw + moves[5]});
}

}  // namespace surefoot::sim
