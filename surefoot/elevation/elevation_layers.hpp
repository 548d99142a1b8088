// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/grid/sliding_layer.hpp"

namespace surefoot::elevation {

/// What the map knows, cell by cell (column = ix along +x, row = iy along +y of the map's
/// geometry). A cell is unknown when its height is NaN; then count is 0 and the other layers say
/// nothing.
struct ElevationLayers {
    using Layer = grid::SlidingLayer<float>;

    Layer height_m;                           ///< highest surface seen, in odom
    Layer height_var_m2;                      ///< of the height as seen from the present body
    grid::SlidingLayer<std::uint32_t> count;  ///< measurements fused since the height was set
    grid::SlidingLayer<std::int64_t>
        seen_ns;               ///< last time that a measurement agreed with the height; 0 = never
    Layer horizontal_drift_m;  ///< 1 sigma of the body's horizontal drift since then; NaN
    Layer highest_m;           ///< robust extremes of all points in the cell since the height
    Layer lowest_m;            ///<   was first set: a wall or an edge spans more than a floor
    Layer clearance_m;         ///< from the height to the lowest thing seen above it; NaN = none
    /// Of an unknown cell: lines of sight passed over it at this height or lower, in two frames at
    /// least (one may hold a wrong match); ground there lies lower. Evidence of drops that are
    /// never seen themselves. NaN = none passed.
    Layer free_above_m;
    /// Share of the looks at the cell that agreed with its height, the last four or so; a height
    /// that was just set has 1/2.
    Layer confidence;
    /// Points seen over points that level ground would show there (Oniga and Nedevschi 2010), over
    /// the same looks: a wall shows many times more. NaN = measured without a camera.
    Layer density_ratio;
};

}  // namespace surefoot::elevation
