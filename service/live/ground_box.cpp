// SPDX-License-Identifier: Apache-2.0
#include "service/live/ground_box.hpp"

#include <utility>

namespace surefoot::app {

std::vector<Eigen::Vector2d> box_outline(const GroundBox& box, const Pose& T_odom_body) {
    std::vector<Eigen::Vector2d> corners;
    for (const auto& [sx, sy] : {std::pair{1, 1}, {1, -1}, {-1, -1}, {-1, 1}}) {
        const Eigen::Vector3d p_body(
            kTenthMm_m * (box.center_x_tenth_mm + 0.5 * sx * box.length_tenth_mm),
            kTenthMm_m * (box.center_y_tenth_mm + 0.5 * sy * box.width_tenth_mm),
            0.0);
        corners.push_back((T_odom_body * p_body).head<2>());
    }
    return corners;
}

}  // namespace surefoot::app
