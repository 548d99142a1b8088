// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/maps/cell_colors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace surefoot::eval {
namespace {

constexpr double kNoHeight = std::numeric_limits<double>::quiet_NaN();

/// Returns the height difference per cell along one axis, from the known neighbours; 0 without
/// known neighbours.
double difference_along(const grid::Layer& height_m, grid::Cell cell, int dx, int dy) {
    const auto at = [&](int sign) {
        const int ix = cell.ix + sign * dx;
        const int iy = cell.iy + sign * dy;
        return height_m.contains(ix, iy) ? static_cast<double>(height_m.at(ix, iy)) : kNoHeight;
    };
    const auto here = static_cast<double>(height_m.at(cell.ix, cell.iy));
    const double before = at(-1);
    const double after = at(+1);
    if (std::isfinite(before) && std::isfinite(after)) return 0.5 * (after - before);
    if (std::isfinite(after)) return after - here;
    return std::isfinite(before) ? here - before : 0.0;
}

/// Returns the Lambertian shade under light from the upper left (+x, +y); 1 on level ground.
double hill_shade(const grid::Layer& height_m, double resolution_m, grid::Cell cell) {
    const double slope_x = difference_along(height_m, cell, 1, 0) / resolution_m;
    const double slope_y = difference_along(height_m, cell, 0, 1) / resolution_m;
    constexpr double kLight_xy = 0.5;
    constexpr double kLight_z = 1.0;
    const double norm = std::sqrt(slope_x * slope_x + slope_y * slope_y + 1.0);
    return (kLight_z - kLight_xy * (slope_x + slope_y)) / (kLight_z * norm);
}

Rgb8 shaded(Rgb8 color, double shade) {
    if (shade >= 1.0) return mixed(color, palette::kPaper, std::min(0.35, 0.6 * (shade - 1.0)));
    return mixed(color, palette::kBlack, std::min(0.6, 0.7 * (1.0 - shade)));
}

}  // namespace

Image<std::optional<Rgb8>> cell_colors(const grid::GridGeometry& geometry,
                                       const grid::Layer& layer,
                                       const LayerStyle& style,
                                       const ColorScale& scale) {
    Image<std::optional<Rgb8>> colors(geometry.nx, geometry.ny);
    for (int iy = 0; iy < geometry.ny; ++iy) {
        for (int ix = 0; ix < geometry.nx; ++ix) {
            const double value = style.value_scale * static_cast<double>(layer.at(ix, iy));
            if (!std::isfinite(value)) continue;
            const Rgb8 color = scale(value);
            colors.at(ix, iy) =
                style.hill_shading
                    ? shaded(color, hill_shade(layer, geometry.resolution_m, {ix, iy}))
                    : color;
        }
    }
    return colors;
}

}  // namespace surefoot::eval
