// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::grid {

/// Motion of a window in cells: the content of cell (ix, iy) moves to cell (ix - dx, iy -
/// dy).
struct Shift {
    int dx = 0;
    int dy = 0;
    [[nodiscard]] bool is_zero() const noexcept { return dx == 0 && dy == 0; }
    friend bool operator==(const Shift&, const Shift&) = default;
};

/// A square window over a fixed lattice. Lattice cell k covers [k resolution, (k+1) resolution), so
/// a ground position belongs to the same cell for every position of the window. The window moves by
/// whole cells only.
///
/// At first it is centred on the origin of odom, to half a cell. Its layers are `SlidingLayer`s.
class MovingWindow {
  public:
    /// `length_m` is rounded to whole cells, at least one.
    MovingWindow(double length_m, double resolution_m);

    [[nodiscard]] const GridGeometry& geometry() const noexcept { return geometry_; }
    /// Lattice index of cell (0, 0).
    [[nodiscard]] std::int64_t first_ix() const noexcept { return first_ix_; }
    [[nodiscard]] std::int64_t first_iy() const noexcept { return first_iy_; }

    /// Moves the window's centre towards the point by the nearest number of cells; half a cell
    /// rounds away from zero. Ignores a point that is not finite.
    Shift center_on(double x_m, double y_m);

  private:
    void update_origin();

    GridGeometry geometry_;
    std::int64_t first_ix_ = 0;
    std::int64_t first_iy_ = 0;
};

}  // namespace surefoot::grid
