// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/grid/sliding_layer.hpp"

namespace surefoot::elevation {

/// Layers of the map, one value per cell (column = ix along +x, row = iy along +y of the map's
/// geometry). A cell is unknown if its height is NaN; then `count` is 0, and except for
/// `free_above_m` the other layers are not valid.
struct ElevationLayers {
    using Layer = grid::SlidingLayer<float>;

    Layer height_m;                           ///< surface height in odom, without objects above it
    Layer height_var_m2;                      ///< height variance relative to the present body
    grid::SlidingLayer<std::uint32_t> count;  ///< measurements fused since the height was set
    grid::SlidingLayer<std::int64_t>
        seen_ns;               ///< last time that a measurement agreed with the height; 0 = never
    Layer horizontal_drift_m;  ///< 1 sigma of the body's horizontal drift since `seen_ns`
    Layer highest_m;           ///< robust highest point in the cell since the height was set
    Layer lowest_m;            ///< robust lowest point; far below `highest_m` for a wall or an edge
    Layer clearance_m;         ///< distance from height to lowest object above; NaN = no object
    /// Unknown cells only: the ground is lower than this height. Two observations must show this (a
    /// line of sight that passed here, or ground below `min_height_m`), because one may be a wrong
    /// match. The layer is evidence of drops. NaN = fewer than two observations.
    Layer free_above_m;
    /// Share of agreeing observations among about the last four of the cell; 1/2 right after the
    /// height was set.
    Layer confidence;
    /// Measured points divided by the points that level ground would give in the same views (Oniga
    /// and Nedevschi 2010). A wall gives far more than 1. NaN = no camera measured it from above.
    Layer density_ratio;
};

}  // namespace surefoot::elevation
