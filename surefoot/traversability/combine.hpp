// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/disc.hpp"
#include "surefoot/traversability/traversability_config.hpp"

namespace surefoot::traversability {

/// Weighted mean of the three ratings, weights normalised by their sum (> 0). With `mean_nan` a
/// cell is unknown if any of its layers is, whatever the weight. With `zero_dominates` an exact 0
/// in a layer whose weight is above 0 forces 0 first, also over unknown.
void combine(Combine rule,
             const TraversabilityConfig::Weights& weights,
             const grid::Layer& slope,
             const grid::Layer& step,
             const grid::Layer& roughness,
             const CellRect& rect,
             grid::Layer& traversability);

}  // namespace surefoot::traversability
