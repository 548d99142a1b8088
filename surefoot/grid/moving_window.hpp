// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <type_traits>

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
/// Layers stay in geometric order in memory (no wrap-around): moving 240 x 240 floats is a copy of
/// 0.2 MB, and every reader is spared the modulo. Starts centred on the origin. Frame: odom.
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

/// Moves the contents of a layer along with its window, inside its allocation, and fills the cells
/// that came into view. `layer` has the window's size.
template <typename T>
void shift_layer(Image<T>& layer, Shift shift, const T& fill) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (shift.is_zero()) return;
    const int nx = layer.width();
    const int ny = layer.height();
    if (std::abs(shift.dx) >= nx || std::abs(shift.dy) >= ny) {
        layer.fill(fill);
        return;
    }
    const int kept = nx - std::abs(shift.dx);
    const int from_ix = shift.dx > 0 ? shift.dx : 0;
    const int to_ix = shift.dx > 0 ? 0 : -shift.dx;
    const auto move_row = [&](int iy) {
        T* to = layer.row(iy);
        const int from_iy = iy + shift.dy;
        if (from_iy < 0 || from_iy >= ny) {
            for (int ix = 0; ix < nx; ++ix) to[ix] = fill;
            return;
        }
        std::memmove(
            to + to_ix, layer.row(from_iy) + from_ix, static_cast<std::size_t>(kept) * sizeof(T));
        for (int ix = 0; ix < to_ix; ++ix) to[ix] = fill;
        for (int ix = to_ix + kept; ix < nx; ++ix) to[ix] = fill;
    };
    // A row must be read before it is overwritten: walk away from the side that the rows move to.
    if (shift.dy >= 0) {
        for (int iy = 0; iy < ny; ++iy) move_row(iy);
    } else {
        for (int iy = ny - 1; iy >= 0; --iy) move_row(iy);
    }
}

}  // namespace surefoot::grid
