// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "surefoot/sim/scenes/scene.hpp"
#include "surefoot/sim/scenes/scene_node.hpp"
#include "surefoot/sim/scenes/scene_reader.hpp"

namespace surefoot::sim {

/// Of a laser scanner over the ground, on its tripod.
inline constexpr double kTripod_m = 1.6;

/// Inside a solid, or under everything that could carry a tripod.
[[nodiscard]] bool is_buried(const Scene& scene, const Eigen::Vector3d& station_m);

/// The group `scan` of a scene file: where a laser scanner stands, `above_m` over the highest
/// surface there, in the world frame. Fails where that is in a solid, or where no ground is.
[[nodiscard]] std::vector<Eigen::Vector3d> read_stations(SceneReader& reader,
                                                         const SceneNode& group,
                                                         const Scene& scene);

}  // namespace surefoot::sim
