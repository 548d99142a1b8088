// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/disc.hpp"
#include "surefoot/traversability/traversability_config.hpp"

namespace surefoot::traversability {

/// Pass 1: computes the highest minus the lowest known height within the first disc around every
/// known cell of `rect`; NaN at unknown cells. NaN everywhere if the disc is a single cell, because
/// it could only find 0.
void step_heights(const PaddedLayer& height_m,
                  const Disc& first_disc,
                  const CellRect& rect,
                  PaddedLayer& step_height_m);

/// Pass 2: rates every cell with a known step height within the second disc, also unknown cells:
///   s = min(max, n / critical_cells * max), max = largest step height, n = number of step heights
///   above critical. So one noisy cell is no obstacle. Rating = 1 - s / critical, at least 0.
void rate_step(const TraversabilityConfig::Step& config,
               const PaddedLayer& step_height_m,
               const Disc& second_disc,
               const CellRect& rect,
               grid::Layer& step);

}  // namespace surefoot::traversability
