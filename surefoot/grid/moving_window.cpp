// SPDX-License-Identifier: Apache-2.0
#include "surefoot/grid/moving_window.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/grid/whole_cells.hpp"

namespace surefoot::grid {
MovingWindow::MovingWindow(double length_m, double resolution_m) {
    SUREFOOT_ASSERT(resolution_m > 0.0 && length_m > 0.0);
    const int cells = std::max(1, whole_cells(std::round(length_m / resolution_m)));
    geometry_.resolution_m = resolution_m;
    geometry_.nx = cells;
    geometry_.ny = cells;
    first_ix_ = -(cells / 2);
    first_iy_ = first_ix_;
    update_origin();
}

Shift MovingWindow::center_on(double x_m, double y_m) {
    if (!std::isfinite(x_m) || !std::isfinite(y_m)) return {};
    const double half_length_m = 0.5 * geometry_.nx * geometry_.resolution_m;
    const Shift shift{
        nearest_cells(x_m - (geometry_.origin_m.x() + half_length_m), geometry_.resolution_m),
        nearest_cells(y_m - (geometry_.origin_m.y() + half_length_m), geometry_.resolution_m)};
    first_ix_ += shift.dx;
    first_iy_ += shift.dy;
    update_origin();
    return shift;
}

void MovingWindow::update_origin() {
    // Computes the origin from the lattice index, not as a sum of shifts: the origin must not
    // depend on the path of the window.
    geometry_.origin_m = {static_cast<double>(first_ix_) * geometry_.resolution_m,
                          static_cast<double>(first_iy_) * geometry_.resolution_m};
}

}  // namespace surefoot::grid
