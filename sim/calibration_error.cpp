// SPDX-License-Identifier: Apache-2.0
#include "sim/calibration_error.hpp"

#include <Eigen/Geometry>
#include <variant>

namespace surefoot::sim {

void CalibrationError::describe(ConfigVisitor& visitor) {
    visitor.number("right_roll_rad", right_roll_rad, -0.2, 0.2, "turn about the optical axis");
    visitor.number("right_pitch_rad", right_pitch_rad, -0.2, 0.2, "turn about the row direction");
    visitor.number("right_yaw_rad", right_yaw_rad, -0.2, 0.2, "turn about the column direction");
    visitor.number("right_focal_share", right_focal_share, -0.1, 0.1, "focal lengths longer by");
}

camera::StereoRig with_error(const camera::StereoRig& nominal, const CalibrationError& error) {
    camera::StereoRig rig = nominal;
    if (!rig.right) return rig;
    const Eigen::Quaterniond turn =
        Eigen::AngleAxisd(error.right_roll_rad, Eigen::Vector3d::UnitZ()) *
        Eigen::AngleAxisd(error.right_yaw_rad, Eigen::Vector3d::UnitY()) *
        Eigen::AngleAxisd(error.right_pitch_rad, Eigen::Vector3d::UnitX());
    rig.T_left_right.rotation = (turn * rig.T_left_right.rotation).normalized();
    const double longer = 1.0 + error.right_focal_share;
    std::visit(
        [&](auto& lens) {
            lens.fx_px *= longer;
            lens.fy_px *= longer;
        },
        rig.right->model);
    rig.rectified = false;  // its rows are no longer those of the left eye
    return rig;
}

}  // namespace surefoot::sim
