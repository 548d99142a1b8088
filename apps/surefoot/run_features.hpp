// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/stairs/features.hpp"

namespace surefoot::app {

/// What a run says of stairs, drops, kerbs, sills and doors, split by how sure it is.
struct RunFeatures {
    /// Found by two observations or more.
    stairs::TerrainFeatures confirmed;
    /// Found by one observation, or by the final map alone (0 observations).
    stairs::TerrainFeatures unconfirmed;
};

/// Splits what was followed, and compares it with what the map that the run left shows by itself:
/// each feature gets `in_final_map`, and what is in the final map alone joins `unconfirmed`, so
/// that as many features have it as `final_map` has. Pairs are those of eval::feature_errors.
[[nodiscard]] RunFeatures compare_with_final_map(stairs::TerrainFeatures followed,
                                                 const stairs::TerrainFeatures& final_map);

/// The split alone, where the final map could not be read.
[[nodiscard]] RunFeatures split_by_confirmation(stairs::TerrainFeatures followed);

/// "1 flight, 2 drops, ...; 3 edges; 1 drop seen once, not confirmed".
[[nodiscard]] std::string features_count_text(const RunFeatures& features);

}  // namespace surefoot::app
