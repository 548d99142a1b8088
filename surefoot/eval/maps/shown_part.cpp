// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/maps/shown_part.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::eval {
namespace {

using Eigen::Vector2d;

/// Range of cells [ix0, ix1) x [iy0, iy1) of a map.
struct Cells {
    int ix0 = 0, iy0 = 0, ix1 = 0, iy1 = 0;
    [[nodiscard]] bool empty() const { return ix1 <= ix0; }
    void include(grid::Cell cell) {
        const bool first = empty();
        ix0 = first ? cell.ix : std::min(ix0, cell.ix);
        iy0 = first ? cell.iy : std::min(iy0, cell.iy);
        ix1 = std::max(ix1, cell.ix + 1);
        iy1 = std::max(iy1, cell.iy + 1);
    }
};

Cells shown_cells(const grid::GridGeometry& geometry,
                  const grid::Layer& height_m,
                  const Overlays& overlays) {
    Cells shown;
    const auto include_point = [&](const Vector2d& p_m) {
        if (const auto cell = geometry.cell_at(p_m.x(), p_m.y())) shown.include(*cell);
    };
    for (int iy = 0; iy < geometry.ny; ++iy) {
        for (int ix = 0; ix < geometry.nx; ++ix)
            if (std::isfinite(height_m.at(ix, iy))) shown.include({ix, iy});
    }
    for (const Mark& mark : overlays.marks) include_point(mark.point_m);
    for (const Vector2d& p_m : overlays.trajectory_m) include_point(p_m);
    if (overlays.T_odom_body) include_point(overlays.T_odom_body->translation_m.head<2>());
    if (shown.empty()) return {0, 0, geometry.nx, geometry.ny};
    const int around = std::max(2, std::max(shown.ix1 - shown.ix0, shown.iy1 - shown.iy0) / 40);
    return {shown.ix0 - around, shown.iy0 - around, shown.ix1 + around, shown.iy1 + around};
}

}  // namespace

ShownPart shown_part(const grid::GridGeometry& geometry,
                     const grid::Layer& height_m,
                     const Overlays& overlays) {
    const Cells shown = shown_cells(geometry, height_m, overlays);
    ShownPart part{geometry, shown.ix0, shown.iy0};
    part.geometry.nx = shown.ix1 - shown.ix0;
    part.geometry.ny = shown.iy1 - shown.iy0;
    part.geometry.origin_m += geometry.resolution_m * Vector2d(shown.ix0, shown.iy0);
    return part;
}

}  // namespace surefoot::eval
