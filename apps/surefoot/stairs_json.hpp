// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/eval/stairs/feature_errors.hpp"
#include "surefoot/grid/map_snapshot.hpp"
#include "surefoot/stairs/classes/ground_classes.hpp"
#include "surefoot/stairs/features.hpp"

namespace surefoot::app {

/// "imu", "plane" or "assumed", as JSON has it.
[[nodiscard]] const char* gravity_name(grid::GravitySource source);

/// What is said beside the features of a map.
struct StairsContext {
    double resolution_m = 0.0;  ///< side of a cell
    grid::GravitySource gravity_source = grid::GravitySource::assumed;
    std::vector<std::string> assumed = {};
    /// Of a run: what one observation or the final map alone found. Null = nothing was followed.
    const stairs::TerrainFeatures* unconfirmed = nullptr;
};

/// What the ground is, as `stairs` prints it and stairs.json has it. Poses are x, y, z [m] and yaw
/// [rad] in the frame of the map; std = standard error, spread = scatter of the single ones; drops
/// and kerbs have positive heights; `log10_step_ratio` is the decimal logarithm of the likelihood
/// ratio, step over smooth ground. What was followed has `id`, `looks` and `last_seen_s`. What is
/// no number is null. Where gravity was assumed each feature says so.
[[nodiscard]] std::string stairs_json(const stairs::TerrainFeatures& features,
                                      const stairs::GroundClasses& classes,
                                      const StairsContext& context);

/// What has to be said where gravity was assumed; else empty.
[[nodiscard]] std::string gravity_note(grid::GravitySource source);

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
