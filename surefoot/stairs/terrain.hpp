// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::stairs {

/// What is known of the ground; all layers have the size of `geometry`, row iy, column ix. Lengths
/// and places are those of the map's frame (odom, z up).
struct Terrain {
    grid::GridGeometry geometry;
    ImageView<const float> height_m;       ///< highest surface of the cell; NaN = unknown
    ImageView<const float> height_var_m2;  ///< empty = 0
    /// Of unknown cells: lines of sight passed at this height, ground there lies lower. Empty or
    /// NaN = nothing is known.
    ImageView<const float> free_above_m;
    ImageView<const float> clearance_m;  ///< free height above the cell; empty or NaN = open
    /// Points seen over points that level ground would show: vertical faces show many times more.
    /// Empty or NaN = nothing is known.
    ImageView<const float> density_ratio;
    /// Looks that agree on the height; empty = more than one.
    ImageView<const std::uint32_t> looks;
    /// Where the machine stands: what goes down from there is a drop, what goes up is not.
    Eigen::Vector2d stance_m = Eigen::Vector2d::Zero();

    [[nodiscard]] bool known(int ix, int iy) const {
        return height_m.row(iy)[ix] == height_m.row(iy)[ix];
    }
};

}  // namespace surefoot::stairs
