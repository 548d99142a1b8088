// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "surefoot/core/checked_index.hpp"

namespace surefoot::grid {

/// Larger counts of cells than the side of any map; sums of a few of them still fit an int.
inline constexpr int kMostCells = 1 << 24;

/// The integer part of a number of cells, at most kMostCells to either side. NaN gives 0.
[[nodiscard]] inline int whole_cells(double cells) noexcept {
    return clamped_integer<int>(cells, -kMostCells, kMostCells);
}

/// A way in cells, halves away from zero. Larger moves than 2^30 cells make no difference: they
/// empty every window.
[[nodiscard]] inline int nearest_cells(double way_m, double resolution_m) noexcept {
    constexpr int kMaxShiftCells = 1 << 30;
    return std::clamp(
        saturated_integer<int>(std::round(way_m / resolution_m)), -kMaxShiftCells, kMaxShiftCells);
}

}  // namespace surefoot::grid
