// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/edges/edge_place.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "surefoot/grid/whole_cells.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr int kSlices = 16;  ///< number of slices along the edge
/// Distance of the strips from the edge; a matcher spreads a step over +-0.06 m.
constexpr double kNearest_m = 0.075;
constexpr double kStrip_m = 0.05;  ///< depth of the compared ground on either side
constexpr double kMinKnown = 0.6;  ///< smallest share of known slices
constexpr double kMinLevel = 0.8;  ///< smallest share of level slices among the known slices
/// Ground is level if both sides differ by less than half of min(edge height, kHighest_m).
constexpr double kHighest_m = 0.1;

std::optional<double> mean_height_m(const Terrain& terrain,
                                    const Vector2d& from_m,
                                    const Vector2d& step_m,
                                    int steps) {
    double sum_m = 0.0;
    int known = 0;
    for (int k = 0; k < steps; ++k) {
        const Vector2d p_m = from_m + k * step_m;
        const auto cell = terrain.geometry.cell_at(p_m.x(), p_m.y());
        if (!cell || !terrain.known(cell->ix, cell->iy)) continue;
        sum_m += static_cast<double>(terrain.height_m.row(cell->iy)[cell->ix]);
        ++known;
    }
    if (known == 0) return std::nullopt;
    return sum_m / known;
}

}  // namespace

PlaceOfEdge place_of(const Edge& edge, const Terrain& terrain) {
    const double cell_m = terrain.geometry.resolution_m;
    const Vector2d down = edge.down();
    const Vector2d nearest_m = (kNearest_m + 2.0 * edge.across_sigma_m) * down;
    const Vector2d step_m = cell_m * down;
    const int steps = std::max(1, grid::whole_cells(std::round(kStrip_m / cell_m)));
    const double limit_m = 0.5 * std::min(edge.height_m(), kHighest_m);
    int known = 0, level = 0;
    for (int k = 0; k < kSlices; ++k) {
        const Vector2d p_m = edge.from_m + (k + 0.5) / kSlices * (edge.to_m - edge.from_m);
        const auto upper_m = mean_height_m(terrain, p_m - nearest_m, -step_m, steps);
        const auto lower_m = mean_height_m(terrain, p_m + nearest_m, step_m, steps);
        if (!upper_m || !lower_m) continue;
        ++known;
        level += std::abs(*upper_m - *lower_m) < limit_m ? 1 : 0;
    }
    if (known < kMinKnown * kSlices) return PlaceOfEdge::unknown;
    return level >= kMinLevel * known ? PlaceOfEdge::level : PlaceOfEdge::uneven;
}

bool is_observed(const Terrain& terrain, const Eigen::Vector3d& p_m) {
    if (terrain.view) return terrain.view->shows(p_m);
    const auto cell = terrain.geometry.cell_at(p_m.x(), p_m.y());
    return cell && terrain.known(cell->ix, cell->iy);
}

bool is_in_window(const Edge& edge, const Terrain& terrain) {
    const auto has = [&](const Vector2d& p_m) {
        return terrain.geometry.cell_at(p_m.x(), p_m.y()).has_value();
    };
    return has(edge.from_m) || has(edge.middle_m()) || has(edge.to_m);
}

}  // namespace surefoot::stairs
