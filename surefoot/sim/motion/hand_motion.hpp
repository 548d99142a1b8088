// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "surefoot/sim/motion/motion.hpp"
#include "surefoot/sim/motion/smooth_curve.hpp"
#include "surefoot/sim/motion/trolley_motion.hpp"

namespace surefoot::sim {

/// A camera that a walking person carries. All amplitudes are an ASSUMPTION: ordinary walking has
/// 1.8-2 steps a second and 30-40 mm of vertical motion, peak to peak. The defaults are at the
/// lower ends, because arms damp the motion. The vertical acceleration then has peaks of 2.0 m/s^2
/// and an rms of 1.4 m/s^2. The seed changes every amplitude by up to 10 %.
struct HandConfig {
    double height_m = 1.30;   ///< height of base_link above the ground, in front of the chest
    double speed_m_s = 1.0;   ///< walking speed; slow, because the person watches a screen
    double ramp_s = 0.8;      ///< time to reach speed_m_s
    double cadence_hz = 1.8;  ///< lowest steps per second, both feet; the seed adds up to 10 %
    double bob_m = 0.016;     ///< vertical amplitude, at the cadence
    double surge_m = 0.006;   ///< amplitude fore and aft, at the cadence
    double sway_m = 0.015;    ///< amplitude sideways, at half the cadence: one sway in two steps
    double roll_deg = 1.5;    ///< amplitude of the roll, at half the cadence
    double pitch_deg = 1.0;   ///< amplitude of the pitch, at the cadence
    double yaw_deg = 1.5;     ///< amplitude of the yaw, at half the cadence
    double drift_deg = 1.5;   ///< amplitude of the slow drift of roll, pitch and yaw, also at rest
    double drift_m = 0.008;   ///< amplitude of the slow drift of the hands
};

/// Hand-held camera: the path of a trolley without tilt, plus periodic and slow movements. The gait
/// fades in and out with the walk. All movements fade to a stand at the start and at the end. The
/// acceleration is continuous.
class HandMotion final : public Motion {
  public:
    /// Requires at least one waypoint.
    HandMotion(const std::vector<Waypoint>& waypoints,
               const HandConfig& config,
               std::uint64_t seed);

    [[nodiscard]] MotionState at(double time_s) const override;
    [[nodiscard]] double duration_s() const override { return way_.duration_s(); }

  private:
    struct Wave {
        double amplitude = 0.0;
        double omega_rad_s = 0.0;
        double phase_rad = 0.0;
        [[nodiscard]] Jet at(double t_s) const {
            return oscillation(amplitude, omega_rad_s, phase_rad, t_s);
        }
    };
    /// Order: ahead, left, up, roll, pitch, yaw.
    static constexpr std::size_t kAxes = 6;

    TrolleyMotion way_;
    SmoothCurve walking_;  ///< 0 while standing, 1 at full speed
    SmoothCurve alive_;    ///< 0 at the start and at the end of the motion
    std::array<Wave, kAxes> steps_;
    std::array<std::array<Wave, 2>, kAxes> drifts_;
};

}  // namespace surefoot::sim
