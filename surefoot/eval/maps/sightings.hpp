// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/pose.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::eval {

/// An ideal (rectified) camera: pixel (0, 0) is the centre of the top left pixel.
struct PinholeView {
    int width = 0;
    int height = 0;
    double fx_px = 0.0;
    double fy_px = 0.0;
    double cx_px = 0.0;
    double cy_px = 0.0;
};

/// Image column and distance of each cell at its last observation; NaN = never observed.
struct Sightings {
    grid::Layer column_px;  ///< image column of the cell's centre
    grid::Layer range_m;    ///< horizontal distance from the camera to the cell
};

/// Finds for each known cell the latest pose that observes its centre at its height. The centre
/// must be in the image and at most `max_depth_m` away along the optical axis. Ignores occlusion: a
/// cell counts as observed even if another object hides the cell. `T_world_camera`: poses of the
/// optical frame in the map's frame, in time order.
[[nodiscard]] Sightings last_sightings(const grid::GridGeometry& geometry,
                                       const grid::Layer& height_m,
                                       const Trajectory& T_world_camera,
                                       const PinholeView& view,
                                       double max_depth_m);

/// Returns the horizontal distance from each cell's centre to the nearest position of a trajectory
/// (the machine) [m]. NaN everywhere for an empty trajectory.
[[nodiscard]] grid::Layer distance_to(const grid::GridGeometry& geometry,
                                      const Trajectory& trajectory);

}  // namespace surefoot::eval
