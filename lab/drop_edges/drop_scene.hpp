// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lab/drop_edges/zed_bench.hpp"
#include "surefoot/core/rng.hpp"

/// Edges that the camera of the bench looks over, and who sees which ground behind them.
namespace surefoot {

/// What stands behind the edge.
struct Drop {
    const char* name;
    double rise_m;
    int steps;  ///< 1 = kerb; more = flight down, going 0.31 m
};

/// From the camera to the edge, along the ground.
inline constexpr double kEdgeDistances_m[] = {0.67, 1.0, 1.5, 2.0};

/// Upper level z = 0 that ends at x = edge_x, everything turned by `yaw_rad` about the edge's
/// middle. Patterns are drawn, all but the white wall.
[[nodiscard]] sim::Scene drop_scene(const Drop& drop, double edge_x_m, double yaw_rad, Rng& rng);

enum class Sight { outside, hidden, partly, seen };

/// How a point of the ground is seen from a pose: by both eyes, by one at most because something
/// stands in the way, or not in both images at all.
[[nodiscard]] Sight sight_of(const sim::Scene& scene,
                             const camera::StereoRig& rig,
                             const Pose& T_world_body,
                             const Eigen::Vector3d& point_m);

/// A cell is seen when all of 5 x 5 points on its true surface were, from some pose; hidden when
/// none was and each stood behind something.
[[nodiscard]] Sight sight_of_cell(const sim::Scene& scene,
                                  const camera::StereoRig& rig,
                                  const std::vector<Pose>& T_world_body,
                                  const Eigen::Vector2d& center_m);

}  // namespace surefoot
