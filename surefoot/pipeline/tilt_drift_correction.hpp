// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "surefoot/core/config.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/core/report.hpp"

namespace surefoot::pipeline {

/// Reasons for the defaults: the odometry tilts by about 0.4 deg in 100 m of corridor (simulated
/// ZED). One observed plane errs by 0.1 to 0.3 deg. Floors fall by up to 1:80 towards drains.
struct LevelConfig {
    bool enabled = true;
    double slew_deg_s = 0.005;    ///< largest rate of the correction
    double max_tilt_deg = 1.0;    ///< steeper ground is a slope and is not used
    double ignored_deg = 0.3;     ///< a mean tilt up to this is not drift
    double average_s = 20.0;      ///< time over which the tilt is averaged
    double agreeing_share = 0.8;  ///< required share of nearly level observations

    void describe(ConfigVisitor& visitor);
};

/// Keeps odom's z axis vertical over hours. If most of the observed ground is nearly level, its
/// mean tilt in odom is drift. Then the poses of base_link are turned back, so slowly that
/// remembered ground stays in place (0.3 mm per second at 3 m). Positions never change: a pose
/// turns about base_link. Odom itself does not move.
///
/// Pass frames in time order.
class TiltDriftCorrection {
  public:
    explicit TiltDriftCorrection(const LevelConfig& config) : config_(config) {}

    /// Forgets all observations; the next pose starts at `T_odom_body`. `ground_lean_rad`: tilt of
    /// the ground against gravity there, if an accelerometer measured it. Above `ignored_deg` the
    /// floor was not built level and cannot show drift, so no pose is corrected from then on.
    void start_at(const Pose& T_odom_body, double ground_lean_rad = 0.0);
    /// Returns the odometry's estimate of the next frame, with the correction known so far.
    [[nodiscard]] MotionEstimate level(const MotionEstimate& motion);
    /// Takes the ground of that frame, in base_link. Ignores the ground if it is not accepted, or
    /// if the pose is not OK.
    void see(const GroundObservation& ground_body);

    /// Returns the mean tilt of the ground in odom along x and y [rad], for small angles. Empty
    /// before `average_s` of observed ground, or if too little of it is level (see `start_at` too).
    [[nodiscard]] std::optional<Eigen::Vector2d> lean() const;

  private:
    LevelConfig config_;
    Pose T_odom_body_;  ///< pose of the last frame
    Health health_ = Health::lost;
    std::int64_t time_ns_ = 0;                        ///< stamp of the last frame; 0 = none
    std::int64_t seen_ns_ = 0;                        ///< stamp of the last observation; 0 = none
    Eigen::Vector2d lean_ = Eigen::Vector2d::Zero();  ///< horizontal part of the mean normal
    double level_share_ = 0.0;                        ///< share of nearly level observations
    double seen_s_ = 0.0;                             ///< averaged time so far, at most `average_s`
    bool is_floor_level_ = true;                      ///< true if the run began on level floor
};

}  // namespace surefoot::pipeline
