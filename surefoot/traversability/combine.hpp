// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/disc.hpp"
#include "surefoot/traversability/traversability_config.hpp"

namespace surefoot::traversability {

/// Weighted mean of the three ratings; the weights are divided by their sum (> 0). With `mean_nan`,
/// a cell is unknown if any layer is unknown, also with weight 0. With `zero_dominates`, a layer
/// with a weight above 0 and an exact 0 forces 0, also if another layer is unknown.
void combine(Combine rule,
             const TraversabilityConfig::Weights& weights,
             const grid::Layer& slope,
             const grid::Layer& step,
             const grid::Layer& roughness,
             const CellRect& rect,
             grid::Layer& traversability);

}  // namespace surefoot::traversability
