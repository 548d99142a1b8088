// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

bool View::shows(const Eigen::Vector3d& p_map_m) const {
    // Margin of the image in which a matcher finds fewer matches.
    constexpr double kBorder_px = 12.0;
    const Eigen::Vector3d p_camera_m = T_map_camera.inverse() * p_map_m;
    if (!(p_camera_m.z() > 0.0)) return false;
    const double u_px = fx_px * p_camera_m.x() / p_camera_m.z() + cx_px;
    const double v_px = fy_px * p_camera_m.y() / p_camera_m.z() + cy_px;
    const double disparity_px = fx_px * baseline_m / p_camera_m.z();
    return u_px - disparity_px >= kBorder_px && u_px <= width_px - 1.0 - kBorder_px &&
           v_px >= kBorder_px && v_px <= height_px - 1.0 - kBorder_px;
}

double View::range_error_m(double error_px, const Eigen::Vector2d& p_map_m, double z_map_m) const {
    const Eigen::Vector3d p_m(p_map_m.x(), p_map_m.y(), z_map_m);
    return error_px * (p_m - T_map_camera.translation_m).squaredNorm() / (fx_px * baseline_m);
}

double View::pixels_per_m2(const Eigen::Vector3d& p_map_m) const {
    const Eigen::Vector3d ray_m = p_map_m - T_map_camera.translation_m;
    const double depth_m = (T_map_camera.rotation.conjugate() * ray_m).z();
    if (!(depth_m > 0.0 && ray_m.z() < 0.0)) return 0.0;
    return fx_px * fy_px * -ray_m.z() / (depth_m * depth_m * depth_m);
}

double View::unmapped_m(const Eigen::Vector3d& p_map_m, const Eigen::Vector2d& way) const {
    const Eigen::Vector3d ray_m = p_map_m - T_map_camera.translation_m;
    const double along_m = ray_m.head<2>().dot(way);
    if (!(fy_px > 0.0 && along_m > 0.0 && ray_m.z() < 0.0)) return 0.0;
    // An angular error [rad] times range^2 / height is the distance by which the end of the ray
    // moves along the ground.
    const double range_sq_m2 = ray_m.squaredNorm();
    const double ahead_m = unmapped_px / fy_px * range_sq_m2 / -ray_m.z();
    return ahead_m * along_m / ray_m.head<2>().norm();
}

}  // namespace surefoot::stairs
