// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/disc.hpp"
#include "surefoot/traversability/traversability_config.hpp"

namespace surefoot::traversability {

/// Rates slope: 1 - acos(normal z) / critical below the critical slope, else 0; NaN if the normal
/// is unknown. The angle is that of the stored normal (float).
void rate_slope(const TraversabilityConfig::Slope& config,
                const grid::Layer& normal_z,
                const CellRect& rect,
                grid::Layer& slope);

}  // namespace surefoot::traversability
