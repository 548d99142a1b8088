// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/disc.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/core/unknown.hpp"
#include "surefoot/grid/whole_cells.hpp"

namespace surefoot::traversability {
namespace {

double limit_cells2(double radius_m, double resolution_m) noexcept {
    const double radius_cells = radius_m / resolution_m;
    return radius_cells * radius_cells + 1e-6;
}

}  // namespace

CellRect CellRect::clipped(int grid_nx, int grid_ny) const noexcept {
    const int x0 = std::max(ix0, 0);
    const int y0 = std::max(iy0, 0);
    const int x1 = std::min(ix0 + nx, grid_nx);
    const int y1 = std::min(iy0 + ny, grid_ny);
    return {x0, y0, std::max(x1 - x0, 0), std::max(y1 - y0, 0)};
}

void PaddedLayer::reset(const CellRect& rect, int margin) {
    ix0_ = rect.ix0 - margin;
    iy0_ = rect.iy0 - margin;
    const int above = margin + rect.ny;
    cells_.resize(rect.nx + 2 * margin + kSlack, above + margin);
    const int width = cells_.width();
    for (int row = 0; row < cells_.height(); ++row) {
        float* const cells = cells_.row(row);
        const bool padding = row < margin || row >= above;
        std::fill_n(cells, padding ? width : margin, kNanF);
        std::fill(cells + margin + rect.nx, cells + width, kNanF);
    }
}

void PaddedLayer::load(ImageView<const float> source, const CellRect& rect) {
    for (int iy = rect.iy0; iy < rect.iy0 + rect.ny; ++iy) {
        const float* from = source.row(iy) + rect.ix0;
        float* to = cell(rect.ix0, iy);
        for (int i = 0; i < rect.nx; ++i) {
            to[i] = std::isfinite(from[i]) ? from[i] : kNanF;
        }
    }
}

int Disc::reach_of(double radius_m, double resolution_m) noexcept {
    return grid::whole_cells(std::sqrt(limit_cells2(radius_m, resolution_m)));
}

int Disc::half_width_of(double radius_m, double resolution_m, int dy) noexcept {
    const double limit = limit_cells2(radius_m, resolution_m);
    int h = 0;
    while (static_cast<double>(h + 1) * (h + 1) + static_cast<double>(dy) * dy <= limit) ++h;
    return h;
}

void Disc::build(double radius_m, double resolution_m, int stride) {
    reach = reach_of(radius_m, resolution_m);
    cells.clear();
    const double limit = limit_cells2(radius_m, resolution_m);
    for (int dy = -reach; dy <= reach; ++dy) {
        for (int dx = -reach; dx <= reach; ++dx) {
            if (static_cast<double>(dx) * dx + static_cast<double>(dy) * dy > limit) continue;
            cells.push_back({static_cast<std::ptrdiff_t>(dy) * stride + dx,
                             dx * resolution_m,
                             dy * resolution_m});
        }
    }
}

}  // namespace surefoot::traversability
