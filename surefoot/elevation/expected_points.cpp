// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/expected_points.hpp"

namespace surefoot::elevation {

ExpectedPoints::ExpectedPoints(const camera::RectifiedRig& rig,
                               const Pose& T_odom_body,
                               const grid::GridGeometry& geometry) {
    const Pose T_odom_camera = T_odom_body * rig.T_body_camera;
    const Eigen::Vector3d axis = T_odom_camera.R().col(2);
    const Eigen::Vector2d first_m =
        geometry.center_m({0, 0}) - T_odom_camera.translation_m.head<2>();
    const double area_m2 = geometry.resolution_m * geometry.resolution_m;
    scale_m2_ = static_cast<float>(area_m2 * rig.fx_px * rig.fy_px);
    x_m_ = static_cast<float>(first_m.x());
    y_m_ = static_cast<float>(first_m.y());
    camera_z_m_ = static_cast<float>(T_odom_camera.translation_m.z());
    resolution_m_ = static_cast<float>(geometry.resolution_m);
    axis_x_ = static_cast<float>(axis.x());
    axis_y_ = static_cast<float>(axis.y());
    axis_z_ = static_cast<float>(axis.z());
}

}  // namespace surefoot::elevation
