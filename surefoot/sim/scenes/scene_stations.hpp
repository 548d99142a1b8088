// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "surefoot/sim/scenes/scene.hpp"
#include "surefoot/sim/scenes/scene_node.hpp"
#include "surefoot/sim/scenes/scene_reader.hpp"

namespace surefoot::sim {

/// Height of a laser scanner on its tripod above the ground.
inline constexpr double kTripod_m = 1.6;

/// Returns true if a station is inside a solid, or below every surface that could carry a tripod.
[[nodiscard]] bool is_buried(const Scene& scene, const Eigen::Vector3d& station_m);

/// Reads the group `scan` of a scene file: world positions of the laser scanner, `above_m` above
/// the highest surface. Fails if a position has no ground.
[[nodiscard]] std::vector<Eigen::Vector3d> read_stations(SceneReader& reader,
                                                         const SceneNode& group,
                                                         const Scene& scene);

}  // namespace surefoot::sim
