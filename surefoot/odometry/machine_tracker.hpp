// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "surefoot/core/frame.hpp"
#include "surefoot/odometry/inertial/inertial_tracker.hpp"

namespace surefoot::odometry {

/// Combines the motion that the machine reports with visual odometry. The reported motion carries
/// the pose while the cameras see nothing and improves the visual pose by its covariance. It is
/// ignored in frames where it contradicts vision (a foot slips, a wheel spins). Order of calls:
/// `advance`, then `improved` or `reckoned`, then `place` if the frame has a pose.
class MachineTracker {
  public:
    explicit MachineTracker(const Pose& T_body_camera) : T_body_camera_(T_body_camera) {}

    /// Adds the motion up to the present frame. Without a motion no pose is known until `place`.
    void advance(const std::optional<MachineMotion>& motion);
    /// Camera pose from the machine alone, with the covariance of the motion since `place`.
    [[nodiscard]] std::optional<CameraFix> reckoned() const;
    /// Combines the visual pose `seen` with the machine's pose, weighted by their covariances.
    /// Returns `seen` unchanged if the machine has no pose or contradicts it.
    [[nodiscard]] CameraFix improved(const CameraFix& seen);
    /// Sets the camera pose of the present frame, from which the next motion continues.
    void place(const Pose& T_odom_camera);
    /// True if the machine contradicted vision in several frames in a row.
    [[nodiscard]] bool disagrees() const noexcept;

  private:
    Pose T_body_camera_;
    Pose T_odom_camera_;                        ///< result of the last `place`
    std::optional<MachineMotion> since_place_;  ///< motion of base_link since the last `place`
    bool placed_ = false;
    int contradictions_ = 0;  ///< number of consecutive contradictions
};

}  // namespace surefoot::odometry
