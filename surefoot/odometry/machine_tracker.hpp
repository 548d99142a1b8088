// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "surefoot/core/frame.hpp"
#include "surefoot/odometry/inertial/inertial_tracker.hpp"

namespace surefoot::odometry {

/// What the machine says about its own motion, beside visual odometry: it carries the pose while
/// nothing is seen, weighs in where it is surer than the eyes, and is left out where it contradicts
/// them (a foot that slips, a wheel that spins). Order of a frame: `advance`, then `improved` or
/// `reckoned`; `place` once it was seen.
class MachineTracker {
  public:
    explicit MachineTracker(const Pose& T_body_camera) : T_body_camera_(T_body_camera) {}

    /// The motion up to the present frame. Without it nothing is known until `place`.
    void advance(const std::optional<MachineMotion>& motion);
    /// The camera as the machine alone has it, with the covariance of the motion since `place`.
    [[nodiscard]] std::optional<CameraFix> reckoned() const;
    /// The pose that was seen, and the machine's, by their covariances; as it was where there is
    /// only one or they contradict each other.
    [[nodiscard]] CameraFix improved(const CameraFix& seen);
    /// The present frame was seen here.
    void place(const Pose& T_odom_camera);
    /// Contradictions for some frames in a row.
    [[nodiscard]] bool disagrees() const noexcept;

  private:
    Pose T_body_camera_;
    Pose T_odom_camera_;                        ///< of the last `place`
    std::optional<MachineMotion> since_place_;  ///< of base_link
    bool placed_ = false;
    int contradictions_ = 0;  ///< in a row
};

}  // namespace surefoot::odometry
