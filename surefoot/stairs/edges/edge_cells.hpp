// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::stairs {

/// Calls `visit(ix, iy, s_cells, t_cells)` for each cell in a rectangle about a line, row by row.
/// `line` has from_m, to_m, along(), down() and length_m() (EdgeLine, Edge). s_cells: distance
/// across the line to the cell centre, counted from `upper_cells` cells above the line, in [0,
/// slices). t_cells: distance along the line from its beginning [cells].
template <typename Line, typename Visit>
void for_each_cell_about(const grid::GridGeometry& grid,
                         const Line& line,
                         int upper_cells,
                         int slices,
                         const Visit& visit) {
    const double cell_m = grid.resolution_m;
    const Eigen::Vector2d along = line.along() / cell_m;
    const Eigen::Vector2d down = line.down() / cell_m;
    const double length = line.length_m() / cell_m;
    const auto most = static_cast<double>(slices);
    for (int iy = 0; iy < grid.ny; ++iy) {
        // Along a row both coordinates are linear in ix [cells].
        const Eigen::Vector2d first_m = grid.center_m({0, iy}) - line.from_m;
        const double t = first_m.dot(along);
        const double s = first_m.dot(down) + upper_cells;
        const double t_step = along.x() * cell_m;
        const double s_step = down.x() * cell_m;
        double low = 0.0;
        double high = grid.nx - 1;
        const auto keep = [&](double value, double step, double end) {
            if (std::abs(step) < 1e-9) {
                if (value < 0.0 || value >= end) high = -1.0;
                return;
            }
            const double a = -value / step;
            const double b = (end - value) / step;
            low = std::max(low, std::min(a, b));
            high = std::min(high, std::max(a, b));
        };
        keep(t, t_step, length);
        keep(s, s_step, most);
        // A line almost parallel to the rows can give bounds beyond the range of int.
        const int first =
            static_cast<int>(std::ceil(std::min(low, 1.0 * grid.nx)));  // in range: 0 to nx
        for (int ix = first; ix <= high; ++ix) {
            const double at_slice = s + s_step * ix;
            if (!(at_slice >= 0.0 && at_slice < most)) continue;  // rounding can leave the range
            visit(ix, iy, at_slice, t + t_step * ix);
        }
    }
}

}  // namespace surefoot::stairs
