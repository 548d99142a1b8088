// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/sampling/cloud_points.hpp"

#include <cmath>

namespace surefoot::elevation {
namespace {

bool is_measurement(const MeasuredPoint& point) {
    return point.p_sensor_m.allFinite() && !point.p_sensor_m.isZero(0.0F) &&
           std::isfinite(point.along_var_m2) && std::isfinite(point.lateral_var_m2) &&
           point.along_var_m2 >= 0.0F && point.lateral_var_m2 >= 0.0F;
}

/// Returns the covariance of equal errors in roll and pitch. In the sensor frame, the axes of both
/// errors are perpendicular to gravity.
Matrix6 tilt_covariance(double sigma_rad, const Eigen::Vector3d& up_sensor) {
    Matrix6 covariance = Matrix6::Zero();
    covariance.bottomRightCorner<3, 3>() =
        sigma_rad * sigma_rad * (Eigen::Matrix3d::Identity() - up_sensor * up_sensor.transpose());
    return covariance;
}

}  // namespace

void points_from_cloud(const ElevationConfig& config,
                       std::span<const MeasuredPoint> cloud,
                       const Pose& T_body_sensor,
                       const Pose& T_odom_body,
                       const Eigen::Vector2d& grid_origin_m,
                       std::vector<GridPoint>& points,
                       FusionCounts& counts) {
    points.clear();
    points.reserve(cloud.size());
    const Pose T_odom_sensor = T_odom_body * T_body_sensor;
    const Eigen::Vector3d up_sensor = T_odom_sensor.R().row(2).transpose();
    const Matrix6 pose_covariance = tilt_covariance(config.camera_tilt_sigma_rad, up_sensor);
    for (const MeasuredPoint& point : cloud) {
        if (!is_measurement(point)) continue;
        ++counts.points;
        const Eigen::Vector3d p_sensor_m = point.p_sensor_m.cast<double>();
        const Eigen::Vector3d p_m = T_odom_sensor * p_sensor_m;
        const double over_body_m = p_m.z() - T_odom_body.translation_m.z();
        if (!is_in_range(config.prefilter, p_sensor_m.norm())) {
            ++counts.gated_range;
        } else if (!is_in_height(config.prefilter, over_body_m)) {
            ++counts.gated_height;
        } else {
            const RayVariance ray{static_cast<double>(point.along_var_m2),
                                  static_cast<double>(point.lateral_var_m2)};
            points.push_back({static_cast<float>(p_m.x() - grid_origin_m.x()),
                              static_cast<float>(p_m.y() - grid_origin_m.y()),
                              static_cast<float>(p_m.z()),
                              static_cast<float>(height_variance_m2(
                                  ray, p_sensor_m, up_sensor, pose_covariance))});
        }
    }
}

}  // namespace surefoot::elevation
