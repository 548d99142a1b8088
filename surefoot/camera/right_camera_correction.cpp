// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/right_camera_correction.hpp"

#include <Eigen/Geometry>
#include <variant>

namespace surefoot::camera {

StereoRig with_right_camera(const StereoRig& nominal, const RightCameraCorrection& this_camera) {
    StereoRig rig = nominal;
    if (!rig.right) return rig;
    const Eigen::Quaterniond turn =
        Eigen::AngleAxisd(this_camera.roll_rad, Eigen::Vector3d::UnitZ()) *
        Eigen::AngleAxisd(this_camera.yaw_rad, Eigen::Vector3d::UnitY()) *
        Eigen::AngleAxisd(this_camera.pitch_rad, Eigen::Vector3d::UnitX());
    rig.T_left_right.rotation = (turn * rig.T_left_right.rotation).normalized();
    const double longer = 1.0 + this_camera.focal_share;
    std::visit(
        [&](auto& lens) {
            lens.fx_px *= longer;
            lens.fy_px *= longer;
        },
        rig.right->model);
    rig.rectified = false;  // after the correction, the rows of the two images do not match
    return rig;
}

}  // namespace surefoot::camera
