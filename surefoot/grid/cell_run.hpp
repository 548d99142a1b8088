// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::grid {

/// Neighbouring cells of row `iy`: columns [first, end), which may lie outside of a grid.
struct CellRun {
    std::int64_t iy = 0;
    std::int64_t first = 0;
    std::int64_t end = 0;

    [[nodiscard]] std::int64_t cells() const noexcept {
        return std::max<std::int64_t>(end - first, 0);
    }
    /// Returns the part of the run inside the grid. It has no cells if the run lies outside.
    [[nodiscard]] CellRun clipped(const GridGeometry& grid) const noexcept {
        if (iy < 0 || iy >= grid.ny) return {iy, first, first};
        const CellRun part{
            iy, std::max<std::int64_t>(first, 0), std::min<std::int64_t>(end, grid.nx)};
        return part.end > part.first ? part : CellRun{iy, first, first};
    }
    friend bool operator==(const CellRun&, const CellRun&) = default;
};

}  // namespace surefoot::grid
