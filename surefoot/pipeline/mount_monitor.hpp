// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "surefoot/core/report.hpp"
#include "surefoot/pipeline/alignment.hpp"

namespace surefoot::pipeline {

/// Detects that the camera has moved on the machine since odom was placed (hazard H6). A knocked
/// camera takes base_link along: the map stays correct, but the feet are elsewhere in base_link.
/// The fault is reported and latched; the monitor never corrects the pose.
///
/// The monitor compares the lean of base_link with two references: odom's z axis and the ground
/// plane. On a slope, base_link leans only against the plane. If the odometry drifts, it leans only
/// against odom. A knocked camera leans against both by the same turn. A walking machine sways
/// (REX: up to 5.4 deg in simulation), but stands upright between steps. After a knock the lean
/// stays.
///
/// The monitor cannot detect turns about the vertical or shifts. Pass frames in time order.
class MountMonitor {
  public:
    explicit MountMonitor(const AlignmentConfig& config) : config_(config) {}

    /// Judges one frame. `ground_body`: its ground plane. The first healthy frame with a plane sets
    /// the reference attitude; unhealthy frames and frames without a plane are not judged.
    void add(const MotionEstimate& motion, const GroundObservation& ground_body);

    [[nodiscard]] bool moved() const noexcept { return moved_; }
    /// True if base_link leaned in the last judged frame by over `max_lean_before_step_deg`: in
    /// mid-step, or because the camera was knocked. A step ends upright, and then the lean ends.
    /// The lean of a knock stays, also after `moved` has reported it.
    [[nodiscard]] bool leans() const noexcept { return leans_; }
    /// Lean of base_link [rad] in the last judged frame; 0 if the two references disagree.
    [[nodiscard]] double lean_rad() const noexcept { return lean_rad_; }

  private:
    void compare(const Pose& T_odom_body, const Eigen::Vector3d& normal_body);

    AlignmentConfig config_;
    bool started_ = false;
    Eigen::Vector3d up_body_ = Eigen::Vector3d::UnitZ();      ///< odom's z axis at the start
    Eigen::Vector3d normal_body_ = Eigen::Vector3d::UnitZ();  ///< the ground's normal at the start
    std::optional<std::int64_t> last_ns_;
    double upright_s_ = 0.0;  ///< duration of the present upright phase
    double leaning_s_ = 0.0;  ///< duration of the present lean at rest
    double swaying_s_ = 0.0;  ///< duration of the present lean above `max_sway_deg`
    double away_s_ = 0.0;     ///< total leaning time since the last upright phase
    double lean_rad_ = 0.0;
    bool leans_ = false;
    bool moved_ = false;
};

}  // namespace surefoot::pipeline
