// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "eval/feature_errors.hpp"
#include "surefoot/core/result.hpp"
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

/// What such a file holds of features, or a file of truth written by hand: places and measures.
struct ListedFeatures {
    stairs::TerrainFeatures features;
    std::set<std::string>
        lists;  ///< that are in the file; one that is not says nothing of its kind
};

/// Wanted are the lists, in each object `pose` (edges: `from` and `to`), and `kind` and `steps`
/// where they are part of it; other numbers may be missing or null and are then not known (NaN).
/// Input errors name the file, where in it and what is wrong; so does a file without any list.
[[nodiscard]] Result<ListedFeatures> parse_stairs(std::string_view text, const std::string& file);

/// Of `eval stairs`: `lists` are those that were compared, the others are null.
[[nodiscard]] std::string feature_errors_json(const eval::FeatureErrors& errors,
                                              const std::set<std::string>& lists);

}  // namespace surefoot::app
