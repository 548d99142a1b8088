// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "surefoot/core/pose.hpp"
#include "surefoot/sim/motion/rex_joints.hpp"

namespace surefoot::sim {

/// Pose of base_link with its exact derivatives.
struct MotionState {
    Pose T_world_body;
    Eigen::Vector3d velocity_world_m_s = Eigen::Vector3d::Zero();
    Eigen::Vector3d acceleration_world_m_s2 = Eigen::Vector3d::Zero();
    Eigen::Vector3d angular_velocity_body_rad_s = Eigen::Vector3d::Zero();
    Eigen::Vector3d angular_acceleration_body_rad_s2 = Eigen::Vector3d::Zero();
};

/// Pose of base_link over time. It can be queried at any time, because image rows and inertial
/// samples lie between the frame stamps. Several threads may query it at once. The body stands
/// still before the start and after the end.
class Motion {
  public:
    virtual ~Motion() = default;
    [[nodiscard]] virtual MotionState at(double time_s) const = 0;
    [[nodiscard]] virtual double duration_s() const = 0;
    /// Joint angles of a walking REX; no value for the other motion models, which have no joints.
    [[nodiscard]] virtual std::optional<RexJoints> rex_joints(double /*time_s*/) const {
        return std::nullopt;
    }
};

}  // namespace surefoot::sim
