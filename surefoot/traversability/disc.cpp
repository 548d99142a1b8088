// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/disc.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

void PaddedLayer::reset(int nx, int ny, int margin) {
    margin_ = margin;
    cells_.resize(nx + 2 * margin, ny + 2 * margin);
    cells_.fill(std::numeric_limits<float>::quiet_NaN());
}

void PaddedLayer::load(ImageView<const float> source, const CellRect& rect) {
    for (int iy = rect.iy0; iy < rect.iy0 + rect.ny; ++iy) {
        const float* from = source.row(iy);
        float* to = row(iy);
        for (int ix = rect.ix0; ix < rect.ix0 + rect.nx; ++ix) {
            to[ix] = std::isfinite(from[ix]) ? from[ix] : std::numeric_limits<float>::quiet_NaN();
        }
    }
}

int Disc::reach_of(double radius_m, double resolution_m) noexcept {
    return static_cast<int>(std::sqrt(limit_cells2(radius_m, resolution_m)));
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
