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

/// How base_link moves through the world, known at any time: images are exposed and inertial
/// samples taken between the frames too. Immutable; may be asked from several threads. Before its
/// start and after its end it stands still.
class Motion {
  public:
    virtual ~Motion() = default;
    [[nodiscard]] virtual MotionState at(double time_s) const = 0;
    [[nodiscard]] virtual double duration_s() const = 0;
    /// Of a walking REX; what only carries a camera has no joints.
    [[nodiscard]] virtual std::optional<RexJoints> rex_joints(double /*time_s*/) const {
        return std::nullopt;
    }
};

}  // namespace surefoot::sim
