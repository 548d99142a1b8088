// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/sampling/expected_points.hpp"

#include <cmath>

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

    // A pixel reaches half a pixel beyond its centre. The right camera limits the common view only
    // at the left side of the left image.
    const double left = rig.cx_px + 0.5;
    const double top = rig.cy_px + 0.5;
    const std::array<Eigen::Vector3d, 4> inwards = {
        Eigen::Vector3d(rig.fx_px, 0.0, left),
        Eigen::Vector3d(-rig.fx_px, 0.0, rig.width - left),
        Eigen::Vector3d(0.0, rig.fy_px, top),
        Eigen::Vector3d(0.0, -rig.fy_px, rig.height - top)};
    const double radius_m = std::sqrt(0.5) * geometry.resolution_m;
    const auto side = [&](const Eigen::Vector3d& inwards_camera, double camera_x_m) {
        const Eigen::Vector3d n = inwards_camera / std::sqrt(inwards_camera.squaredNorm());
        const Eigen::Vector3d n_odom = T_odom_camera.R() * n;
        return Side{static_cast<float>(n_odom.x()),
                    static_cast<float>(n_odom.y()),
                    static_cast<float>(n_odom.z()),
                    static_cast<float>(-n.x() * camera_x_m - radius_m)};
    };
    for (std::size_t i = 0; i < inwards.size(); ++i) sides_[i] = side(inwards[i], 0.0);
    sides_[4] = side(inwards[0], rig.baseline_m);
}

}  // namespace surefoot::elevation
