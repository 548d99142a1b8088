// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/disc.hpp"
#include "surefoot/traversability/traversability_config.hpp"

namespace surefoot::traversability {

/// Rates roughness: r = sqrt(sum (n . p_i - n . mean)^2 / (N - 1)) over the N known cells p_i of
/// the disc, with the normal n of the centre cell; rating = 1 - r / critical, at least 0. A cell
/// without a known neighbour gets 0: nothing proves it smooth. NaN if the normal is unknown.
void rate_roughness(const TraversabilityConfig::Roughness& config,
                    const PaddedLayer& height_m,
                    const Disc& disc,
                    const grid::Layer& normal_x,
                    const grid::Layer& normal_y,
                    const grid::Layer& normal_z,
                    const CellRect& rect,
                    grid::Layer& roughness);

}  // namespace surefoot::traversability
