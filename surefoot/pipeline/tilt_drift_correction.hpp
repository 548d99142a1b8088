// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "surefoot/core/config.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/core/report.hpp"

namespace surefoot::pipeline {

/// Defaults: the odometry leans by some 0.4 deg in 100 m of corridor (the simulated ZED); a plane
/// that is seen once by 0.1 to 0.3 deg, and floors fall by up to 1:80 for their drains.
struct LevelConfig {
    bool enabled = true;
    double slew_deg_s = 0.005;    ///< at most
    double max_tilt_deg = 1.0;    ///< ground steeper than that is a slope, and says nothing
    double ignored_deg = 0.3;     ///< a mean tilt within it is no drift
    double average_s = 20.0;      ///< time that the tilt is averaged over
    double agreeing_share = 0.8;  ///< of the sightings that must be nearly level

    void describe(ConfigVisitor& visitor);
};

/// Keeps odom's z axis vertical over hours: where the ground is level on the average of many
/// sightings, what it leans in odom is drift, and the poses of base_link are turned back, so slowly
/// that remembered ground stays where it is (0.3 mm a second at 3 m). Positions never change by it:
/// a pose turns about base_link. Odom itself does not move.
///
/// Frames in time order.
class TiltDriftCorrection {
  public:
    explicit TiltDriftCorrection(const LevelConfig& config) : config_(config) {}

    /// Forgets what was seen; the first pose will be this one. `ground_lean_rad`: what the ground
    /// leans there against gravity, where an accelerometer tells. Beyond `ignored_deg` the floor is
    /// not built level, and says nothing about drift: nothing is turned back from then on.
    void start_at(const Pose& T_odom_body, double ground_lean_rad = 0.0);
    /// The odometry's estimate of the next frame, turned by what is known so far.
    [[nodiscard]] MotionEstimate level(const MotionEstimate& motion);
    /// The ground in that frame, in base_link. What is not accepted, or seen while the pose is not
    /// OK, is not used.
    void see(const GroundObservation& ground_body);

    /// What the ground leans in odom on the average: along x and y, for small angles; nothing
    /// before it was seen for `average_s`.
    [[nodiscard]] std::optional<Eigen::Vector2d> lean() const;

  private:
    LevelConfig config_;
    Pose T_odom_body_;  ///< of the last frame
    Health health_ = Health::lost;
    std::int64_t time_ns_ = 0;                        ///< of the last frame; 0 = none
    std::int64_t seen_ns_ = 0;                        ///< of the last sighting; 0 = none
    Eigen::Vector2d lean_ = Eigen::Vector2d::Zero();  ///< horizontal part of the mean normal
    double level_share_ = 0.0;                        ///< of the sightings that were nearly level
    double seen_s_ = 0.0;                             ///< time that was averaged
    bool is_floor_level_ = true;                      ///< where the run began
};

}  // namespace surefoot::pipeline
