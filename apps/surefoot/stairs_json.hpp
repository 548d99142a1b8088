// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/ground_classes.hpp"

namespace surefoot::app {

/// What the ground is, as `stairs` prints it and stairs.json has it. Poses are x, y, z [m] and yaw
/// [rad] in the frame of the map; std = standard error, spread = scatter of the single ones; drops
/// and kerbs have positive heights. `resolution_m`: side of a cell. What was followed has `id`,
/// `looks` and `last_seen_s`. What is no number is null.
[[nodiscard]] std::string stairs_json(const stairs::TerrainFeatures& features,
                                      const stairs::GroundClasses& classes,
                                      double resolution_m,
                                      const std::vector<std::string>& assumed);

}  // namespace surefoot::app
