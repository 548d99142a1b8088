// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "surefoot/core/checked_index.hpp"

namespace surefoot::grid {

/// Exceeds the side of any map [cells]; sums of a few such numbers still fit an int.
inline constexpr int kMostCells = 1 << 24;

/// Returns the integer part of a number of cells, limited to +-kMostCells. NaN gives 0.
[[nodiscard]] inline int whole_cells(double cells) noexcept {
    return clamped_integer<int>(cells, -kMostCells, kMostCells);
}

/// Returns a distance as the nearest number of cells; halves round away from zero. Limited to 2^30
/// cells, which is enough to empty every window.
[[nodiscard]] inline int nearest_cells(double way_m, double resolution_m) noexcept {
    constexpr int kMaxShiftCells = 1 << 30;
    return std::clamp(
        saturated_integer<int>(std::round(way_m / resolution_m)), -kMaxShiftCells, kMaxShiftCells);
}

}  // namespace surefoot::grid
