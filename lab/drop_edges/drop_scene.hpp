// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lab/drop_edges/zed_bench.hpp"
#include "surefoot/core/rng.hpp"

/// Scenes with a drop edge in front of the bench's camera, and the true visibility of the ground
/// behind the edge.
namespace surefoot {

/// A drop behind the edge: a kerb, or a flight of stairs that leads down.
struct Drop {
    const char* name;
    double rise_m;  ///< height of each step [m], positive
    int steps;      ///< 1 = kerb; more than 1 = flight of stairs down, each going 0.31 m
};

/// Horizontal distances from the camera to the edge [m].
inline constexpr double kEdgeDistances_m[] = {0.67, 1.0, 1.5, 2.0};

/// Builds an upper level z = 0 that ends at x = `edge_x_m`, and the drop behind this edge. The
/// scene is rotated by `yaw_rad` about (edge_x_m, 0). `rng` draws the patterns of both levels, but
/// never the white wall.
[[nodiscard]] sim::Scene drop_scene(const Drop& drop, double edge_x_m, double yaw_rad, Rng& rng);

/// True visibility of a point or cell for the stereo pair.
/// `hidden`: inside both images, but something occludes it in at least one camera.
/// `partly`: only for cells, see `sight_of_cell`.
enum class Sight { outside, hidden, partly, seen };

/// Visibility of a point of the world from one body pose. `seen`: both cameras see it. `outside`:
/// the point is within 8 px of an image border, outside an image, or more than 2.8 m from a camera.
[[nodiscard]] Sight sight_of(const sim::Scene& scene,
                             const camera::StereoRig& rig,
                             const Pose& T_world_body,
                             const Eigen::Vector3d& point_m);

/// Visibility of a map cell of side kCellSize_m from a set of poses, by 5 x 5 points on its true
/// surface. `seen`: each point is seen from at least one pose. `hidden`: no point is seen, and each
/// is hidden from at least one pose. `outside`: every point is outside from every pose. Otherwise
/// `partly`.
[[nodiscard]] Sight sight_of_cell(const sim::Scene& scene,
                                  const camera::StereoRig& rig,
                                  const std::vector<Pose>& T_world_body,
                                  const Eigen::Vector2d& center_m);

}  // namespace surefoot
