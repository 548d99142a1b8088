// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/stairs/features.hpp"

namespace surefoot::app {

/// Terrain features of a run (edges, drops, kerbs, sills, flights, doors), split by confirmation.
struct RunFeatures {
    /// Features that two or more observations found.
    stairs::TerrainFeatures confirmed;
    /// Features that one observation found, or only the final map (0 observations).
    stairs::TerrainFeatures unconfirmed;
};

/// Splits the tracked features and compares them with the features of the final map. Sets
/// `in_final_map` of each tracked feature. Features that only the final map contains are added to
/// `unconfirmed`. Features are paired as in eval::feature_errors().
[[nodiscard]] RunFeatures compare_with_final_map(stairs::TerrainFeatures tracked,
                                                 const stairs::TerrainFeatures& final_map);

/// Splits the tracked features without a comparison, for runs whose final map cannot be read.
[[nodiscard]] RunFeatures split_by_confirmation(stairs::TerrainFeatures tracked);

/// Returns "..., 2 drops, ...; 3 edges; 1 drop not confirmed by a second observation".
[[nodiscard]] std::string features_count_text(const RunFeatures& features);

}  // namespace surefoot::app
