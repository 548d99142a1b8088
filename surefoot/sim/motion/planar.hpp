// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace surefoot::sim {

/// Rigid motion in the ground plane, `T_a_b` as for poses: p_a = T_a_b * p_b.
struct PlanarPose {
    Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
    double cos_yaw = 1.0;
    double sin_yaw = 0.0;

    [[nodiscard]] static PlanarPose of(double x_m, double y_m, double yaw_rad) {
        return {{x_m, y_m}, std::cos(yaw_rad), std::sin(yaw_rad)};
    }
    [[nodiscard]] Eigen::Vector2d rotated(const Eigen::Vector2d& v_b) const {
        return {cos_yaw * v_b.x() - sin_yaw * v_b.y(), sin_yaw * v_b.x() + cos_yaw * v_b.y()};
    }
    [[nodiscard]] Eigen::Vector2d operator*(const Eigen::Vector2d& p_b) const {
        return position_m + rotated(p_b);
    }
    [[nodiscard]] PlanarPose operator*(const PlanarPose& T_b_c) const {
        return {*this * T_b_c.position_m,
                cos_yaw * T_b_c.cos_yaw - sin_yaw * T_b_c.sin_yaw,
                sin_yaw * T_b_c.cos_yaw + cos_yaw * T_b_c.sin_yaw};
    }
    /// Returns p_b of a point that is given in frame a.
    [[nodiscard]] Eigen::Vector2d inverse_times(const Eigen::Vector2d& p_a) const {
        const Eigen::Vector2d d = p_a - position_m;
        return {cos_yaw * d.x() + sin_yaw * d.y(), -sin_yaw * d.x() + cos_yaw * d.y()};
    }
};

/// z = height_m + slope . p over the ground plane of one frame.
struct LevelPlane {
    double height_m = 0.0;
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();

    [[nodiscard]] double at(const Eigen::Vector2d& p_m) const { return height_m + slope.dot(p_m); }
};

}  // namespace surefoot::sim
