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

/// Returns the name of the gravity source in JSON: "imu", "plane" or "assumed".
[[nodiscard]] const char* gravity_name(grid::GravitySource source);

/// Other content of stairs.json, besides the features.
struct StairsContext {
    double resolution_m = 0.0;  ///< cell size
    grid::GravitySource gravity_source = grid::GravitySource::assumed;
    std::vector<std::string> assumed = {};
    /// Features of a run that only one observation or only the final map contains. Null = all
    /// features come from a single map, without tracking.
    const stairs::TerrainFeatures* unconfirmed = nullptr;
};

/// Terrain features as JSON, as `surefoot stairs` prints them and stairs.json holds them. Poses are
/// x, y, z [m] and yaw [rad] in the frame of the map. `std` is the standard error; `spread` is the
/// scatter of the single values. Drops and kerbs have positive heights. `log10_step_ratio` is the
/// decimal logarithm of the likelihood ratio of a step over smooth ground. Tracked features have
/// `id`, `observations` (their number) and `last_seen_s`. NaN is written as null. If gravity was
/// assumed, each feature says so.
[[nodiscard]] std::string stairs_json(const stairs::TerrainFeatures& features,
                                      const stairs::GroundClasses& classes,
                                      const StairsContext& context);

/// Returns a note for the user if gravity was assumed; otherwise empty.
[[nodiscard]] std::string gravity_note(grid::GravitySource source);

/// Terrain features from stairs.json or from a hand-written file of true features. They contain
/// only poses and measures.
struct ListedFeatures {
    stairs::TerrainFeatures features;
    /// Names of the lists in the file. A missing list says nothing about features of its kind.
    std::set<std::string> lists;
};

/// Reads stairs.json or a hand-written file of true features. Each object needs `pose` (edges:
/// `from` and `to`). Flights and kerbs also need `kind`, flights need `steps`. Other numbers may be
/// missing or null and become NaN. Input errors name the file, the position and the problem. A file
/// without any list is an input error.
[[nodiscard]] Result<ListedFeatures> parse_stairs(std::string_view text, const std::string& file);

/// Returns the result of `surefoot eval stairs`. `lists` names the compared lists; others are null.
[[nodiscard]] std::string feature_errors_json(const eval::FeatureErrors& errors,
                                              const std::set<std::string>& lists);

}  // namespace surefoot::app
