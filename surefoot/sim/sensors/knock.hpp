// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "surefoot/core/config.hpp"
#include "surefoot/sim/motion/motion.hpp"

namespace surefoot::sim {

/// A knock that turns the camera on its mount permanently (hazard H6). The rotation is about the
/// axes of base_link, through the left camera, in the order roll, pitch, yaw as in Rz(yaw)
/// Ry(pitch) Rx(roll). It starts at `at_s`.
struct KnockConfig {
    double at_s = 0.0;  ///< time after the first frame
    double roll_deg = 0.0;
    double pitch_deg = 0.0;  ///< positive = down
    double yaw_deg = 0.0;

    [[nodiscard]] bool none() const noexcept {
        return roll_deg == 0.0 && pitch_deg == 0.0 && yaw_deg == 0.0;
    }
    void describe(ConfigVisitor& visitor);
};

/// ASSUMPTION: duration of the camera's turn; one and a half frames at 15 Hz.
inline constexpr double kKnockDuration_s = 0.1;

/// Motion of a base_link that is fixed to the camera when the camera is knocked. Both cameras and
/// the IMU beside them follow this motion; the machine follows `machine`.
class KnockedMotion final : public Motion {
  public:
    KnockedMotion(std::shared_ptr<const Motion> machine,
                  const KnockConfig& knock,
                  const Eigen::Vector3d& left_camera_body_m);
    [[nodiscard]] MotionState at(double time_s) const override;
    [[nodiscard]] double duration_s() const override { return machine_->duration_s(); }

  private:
    std::shared_ptr<const Motion> machine_;
    double at_s_;
    double angle_rad_;
    Eigen::Vector3d axis_;     ///< unit vector of the rotation axis, in base_link
    Eigen::Vector3d pivot_m_;  ///< point on the rotation axis, in base_link
};

}  // namespace surefoot::sim
