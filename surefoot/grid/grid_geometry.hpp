// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "surefoot/core/views.hpp"

namespace surefoot::grid {

/// One layer of a grid: column = ix along +x, row = iy along +y, NaN = unknown.
using Layer = Image<float>;

/// A cell of a grid, counted from the corner with the smallest x and y.
struct Cell {
    int ix = 0;
    int iy = 0;
    friend bool operator==(const Cell&, const Cell&) = default;
};

/// Position of a grid: axis-parallel square cells; `origin_m` is the outer corner of cell (0, 0). A
/// point lies in cell floor((p - origin) / resolution). Picture: NOTATION.md.
struct GridGeometry {
    double resolution_m = 0.025;
    int nx = 0;
    int ny = 0;
    Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();

    [[nodiscard]] Eigen::Vector2d center_m(Cell cell) const {
        return origin_m + resolution_m * Eigen::Vector2d(cell.ix + 0.5, cell.iy + 0.5);
    }
    [[nodiscard]] bool contains(Cell cell) const noexcept {
        return cell.ix >= 0 && cell.iy >= 0 && cell.ix < nx && cell.iy < ny;
    }
    /// Returns the cell of a point, or nullopt outside the grid and for NaN.
    [[nodiscard]] std::optional<Cell> cell_at(double x_m, double y_m) const noexcept {
        const double ix = std::floor((x_m - origin_m.x()) / resolution_m);
        const double iy = std::floor((y_m - origin_m.y()) / resolution_m);
        if (!(ix >= 0.0 && iy >= 0.0 && ix < nx && iy < ny)) return std::nullopt;
        return Cell{static_cast<int>(ix), static_cast<int>(iy)};
    }
};

}  // namespace surefoot::grid
