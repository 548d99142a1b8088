// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::grid {

/// By how many cells a window moved: what lay in cell (ix, iy) lies in (ix - dx, iy - dy)
/// afterwards.
struct Shift {
    int dx = 0;
    int dy = 0;
    [[nodiscard]] bool is_zero() const noexcept { return dx == 0 && dy == 0; }
    friend bool operator==(const Shift&, const Shift&) = default;
};

/// A square window over a fixed lattice: lattice cell k covers [k resolution, (k+1) resolution), so
/// a place on the ground belongs to the same cell wherever the window is. Moves by whole cells
/// only.
///
/// Starts centred on the origin. Frame: odom. Its layers are `SlidingLayer`s.
class MovingWindow {
  public:
    /// `length_m` is rounded to whole cells, at least one.
    MovingWindow(double length_m, double resolution_m);

    [[nodiscard]] const GridGeometry& geometry() const noexcept { return geometry_; }
    /// Lattice index of cell (0, 0).
    [[nodiscard]] std::int64_t first_ix() const noexcept { return first_ix_; }
    [[nodiscard]] std::int64_t first_iy() const noexcept { return first_iy_; }

    /// Moves by the number of cells nearest to the way from the window's centre to the point; half
    /// a cell rounds away from zero. A point that is not finite moves nothing.
    Shift center_on(double x_m, double y_m);

  private:
    void update_origin();

    GridGeometry geometry_;
    std::int64_t first_ix_ = 0;
    std::int64_t first_iy_ = 0;
};

}  // namespace surefoot::grid
