// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/right_eye.hpp"

#include <Eigen/Geometry>
#include <variant>

namespace surefoot::camera {

StereoRig with_right_eye(const StereoRig& nominal, const RightEye& eye) {
    StereoRig rig = nominal;
    if (!rig.right) return rig;
    const Eigen::Quaterniond turn = Eigen::AngleAxisd(eye.roll_rad, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(eye.yaw_rad, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(eye.pitch_rad, Eigen::Vector3d::UnitX());
    rig.T_left_right.rotation = (turn * rig.T_left_right.rotation).normalized();
    const double longer = 1.0 + eye.focal_share;
    std::visit(
        [&](auto& lens) {
            lens.fx_px *= longer;
            lens.fy_px *= longer;
        },
        rig.right->model);
    rig.rectified = false;  // its rows are no longer those of the left eye
    return rig;
}

}  // namespace surefoot::camera
