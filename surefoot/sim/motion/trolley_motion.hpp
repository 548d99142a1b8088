// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "surefoot/core/pose.hpp"
#include "surefoot/sim/motion/motion.hpp"
#include "surefoot/sim/motion/waypoint.hpp"

namespace surefoot::sim {

struct TrolleyConfig {
    double height_m = 0.95;     ///< height of base_link above the ground
    double speed_m_s = 0.25;    ///< speed between waypoints
    double ramp_s = 1.0;        ///< time to reach speed_m_s, and time to stop
    double turn_lever_m = 0.8;  ///< a turn by 1 rad takes as long as this distance
    bool tilts = true;          ///< follows the slope between two waypoints of different height
};

/// Motion of base_link through waypoints at constant height above the ground. Position and yaw
/// between two waypoints follow one progress function s(t). The speed rises as the smoothstep 3u^2
/// - 2u^3, stays, and falls the same way. So the acceleration is continuous. The body stands still
/// before the start and after the end. It is level at the waypoints. On a slope the tilt grows and
/// vanishes smoothly over 0.3 m, so place waypoints at the foot and at the top of a ramp.
class TrolleyMotion final : public Motion {
  public:
    /// Requires at least one waypoint; with one waypoint the trolley stands there for its pause.
    static TrolleyMotion trolley(const std::vector<Waypoint>& waypoints,
                                 const TrolleyConfig& config);
    static TrolleyMotion stand(const Waypoint& place, double height_m, double duration_s);

    [[nodiscard]] MotionState at(double time_s) const override;
    [[nodiscard]] double duration_s() const override { return duration_s_; }
    /// Start time of each pause, in order.
    [[nodiscard]] std::vector<double> pauses_s() const;

  private:
    struct Segment {
        double start_s = 0.0;
        double length_m = 0.0;  ///< distance, or lever times turn if that is longer; 0 = pause
        double speed_m_s = 0.0;
        double ramp_s = 0.0;
        double duration_s = 0.0;
        bool tilts = true;
        Waypoint from;
        Waypoint to;
    };
    void append_pause(const Waypoint& place);
    void append_way(const Waypoint& from, const Waypoint& to, const TrolleyConfig& config);

    std::vector<Segment> segments_;
    double height_m_ = 0.0;
    double duration_s_ = 0.0;
};

}  // namespace surefoot::sim
