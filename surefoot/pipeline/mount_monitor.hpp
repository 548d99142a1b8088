// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "surefoot/core/report.hpp"
#include "surefoot/pipeline/alignment.hpp"

namespace surefoot::pipeline {

/// Does the camera still sit on the machine as it did when odom was placed (hazard H6)? A knocked
/// camera takes base_link along: the map stays true, but the feet are no longer where base_link
/// says. Reported and latched, never followed.
///
/// What is compared is how base_link leans, told by two witnesses: against odom's z axis, and
/// against the plane of the ground. On a slope only one of them leans, an odometry that drifts
/// leans alone too; a knocked camera leans in both by the same turn. A walking machine sways (REX:
/// up to 5.4 deg in the simulator), but comes home between its steps: what betrays a small knock is
/// that it never does.
///
/// Turns about the vertical and shifts of the mount cannot be seen this way. Frames in time order.
class MountMonitor {
  public:
    explicit MountMonitor(const AlignmentConfig& config) : config_(config) {}

    /// `ground_body`: the plane of this frame. The first healthy frame with a plane is how
    /// base_link stands; frames without are not judged.
    void add(const MotionEstimate& motion, const GroundObservation& ground_body);

    [[nodiscard]] bool moved() const noexcept { return moved_; }
    /// Leaning, by the last frame that was judged: in mid-step, or knocked. A knock of more than
    /// `max_lean_before_step_deg` shows in the next frame, and stays until `moved` says so; a step
    /// ends upright.
    [[nodiscard]] bool leans() const noexcept { return leans_; }
    /// By how much both witnesses say that base_link leans [rad]; of the last frame judged.
    [[nodiscard]] double lean_rad() const noexcept { return lean_rad_; }

  private:
    void compare(const Pose& T_odom_body, const Eigen::Vector3d& normal_body);

    AlignmentConfig config_;
    bool started_ = false;
    Eigen::Vector3d up_body_ = Eigen::Vector3d::UnitZ();      ///< odom's z axis at the start
    Eigen::Vector3d normal_body_ = Eigen::Vector3d::UnitZ();  ///< the ground's likewise
    std::optional<std::int64_t> last_ns_;
    double upright_s_ = 0.0;  ///< until now
    double leaning_s_ = 0.0;  ///< at rest, until now
    double swaying_s_ = 0.0;  ///< farther than any gait, until now
    double away_s_ = 0.0;     ///< leaning, in all, since it stood as at the start
    double lean_rad_ = 0.0;
    bool leans_ = false;
    bool moved_ = false;
};

}  // namespace surefoot::pipeline
