// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/disc.hpp"
#include "surefoot/traversability/traversability_config.hpp"

namespace surefoot::traversability::rows {

/// Gives the same bytes as traversability::combine. Compiled for every instruction set and selected
/// at run time.
void combine(Combine rule,
             const TraversabilityConfig::Weights& weights,
             const grid::Layer& slope,
             const grid::Layer& step,
             const grid::Layer& roughness,
             const CellRect& rect,
             grid::Layer& traversability);

}  // namespace surefoot::traversability::rows
