// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/depth_image.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/report.hpp"
#include "surefoot/elevation/elevation_config.hpp"
#include "surefoot/elevation/fusion/cell_groups.hpp"

namespace surefoot::elevation {

/// Converts the accepted pixels of a depth image into points over a grid: pixel filters, range,
/// height cut, height with its variance. Replaces the contents of `points` and counts the rejected
/// pixels. `grid_origin_m` is the grid corner in odom from which x and y of the points count.
void points_from_depth(const ElevationConfig& config,
                       const camera::RectifiedRig& rig,
                       const Pose& T_odom_body,
                       const DepthImage& depth,
                       const Eigen::Vector2d& grid_origin_m,
                       std::vector<GridPoint>& points,
                       FusionCounts& counts);

}  // namespace surefoot::elevation
