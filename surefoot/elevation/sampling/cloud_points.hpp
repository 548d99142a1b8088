// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "surefoot/core/pose.hpp"
#include "surefoot/core/report.hpp"
#include "surefoot/elevation/elevation_config.hpp"
#include "surefoot/elevation/fusion/cell_groups.hpp"

namespace surefoot::elevation {

/// One point of a cloud with the variances of its sensor (see `ray_variance`).
struct MeasuredPoint {
    Eigen::Vector3f p_sensor_m = Eigen::Vector3f::Zero();
    float along_var_m2 = 0.0F;    ///< variance along the ray
    float lateral_var_m2 = 0.0F;  ///< variance across the ray
};

/// Converts a cloud into points over a grid: range filter, height cut, height with its variance.
/// Replaces the contents of `points` and counts the rejected points. Points at the sensor's origin
/// or with invalid values are skipped and not counted. `grid_origin_m`: see `points_from_depth`.
void points_from_cloud(const ElevationConfig& config,
                       std::span<const MeasuredPoint> cloud,
                       const Pose& T_body_sensor,
                       const Pose& T_odom_body,
                       const Eigen::Vector2d& grid_origin_m,
                       std::vector<GridPoint>& points,
                       FusionCounts& counts);

}  // namespace surefoot::elevation
