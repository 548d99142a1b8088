// SPDX-License-Identifier: Apache-2.0
#include "surefoot/grid/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace surefoot::grid {
namespace {

/// Where the edge a-b crosses the horizontal line at y, or nothing: half-open in y, so that a
/// vertex counts once. One expression for the point test and the scan: they cannot disagree.
std::optional<double> crossing_x(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double y) {
    if ((a.y() > y) == (b.y() > y)) return std::nullopt;
    return a.x() + (b.x() - a.x()) * ((y - a.y()) / (b.y() - a.y()));
}

/// First index whose cell centre is at or right of x.
std::int64_t first_center_from(double x_m, double origin_m, double resolution_m) {
    auto index = static_cast<std::int64_t>(std::floor((x_m - origin_m) / resolution_m)) - 1;
    while (!(origin_m + resolution_m * (static_cast<double>(index) + 0.5) >= x_m)) ++index;
    return index;
}

}  // namespace

Polygon::Polygon(std::vector<Eigen::Vector2d> vertices_m) : vertices_m_(std::move(vertices_m)) {
    const bool finite = std::all_of(
        vertices_m_.begin(), vertices_m_.end(), [](const auto& v) { return v.allFinite(); });
    if (!finite || vertices_m_.size() < 3) vertices_m_.clear();
}

bool Polygon::contains(double x_m, double y_m) const noexcept {
    bool inside = false;
    for (std::size_t i = 0; i < vertices_m_.size(); ++i) {
        const auto x = crossing_x(vertices_m_[i], vertices_m_[(i + 1) % vertices_m_.size()], y_m);
        if (x && x_m >= *x) inside = !inside;
    }
    return inside;
}

std::int64_t cells_in(const Polygon& polygon,
                      const GridGeometry& geometry,
                      const std::function<void(Cell)>& visit) {
    if (polygon.empty() || !(geometry.resolution_m > 0.0)) return 0;
    const auto& vertices = polygon.vertices_m();
    const auto [low, high] =
        std::minmax_element(vertices.begin(), vertices.end(), [](const auto& a, const auto& b) {
            return a.y() < b.y();
        });
    const double res_m = geometry.resolution_m;
    const double origin_y_m = geometry.origin_m.y();
    std::int64_t outside = 0;
    std::vector<double> crossings;
    const std::int64_t end = first_center_from(high->y(), origin_y_m, res_m);
    for (std::int64_t iy = first_center_from(low->y(), origin_y_m, res_m); iy < end; ++iy) {
        const double y_m = origin_y_m + res_m * (static_cast<double>(iy) + 0.5);
        crossings.clear();
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            if (const auto x = crossing_x(vertices[i], vertices[(i + 1) % vertices.size()], y_m))
                crossings.push_back(*x);
        }
        std::sort(crossings.begin(), crossings.end());
        for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
            const auto from = first_center_from(crossings[i], geometry.origin_m.x(), res_m);
            const auto to = first_center_from(crossings[i + 1], geometry.origin_m.x(), res_m);
            const bool row_inside = iy >= 0 && iy < geometry.ny;
            const auto first = row_inside ? std::clamp<std::int64_t>(from, 0, geometry.nx) : from;
            const auto last = row_inside ? std::clamp<std::int64_t>(to, 0, geometry.nx) : from;
            for (auto ix = first; ix < last; ++ix)
                visit({static_cast<int>(ix), static_cast<int>(iy)});
            outside += (to - from) - (last - first);
        }
    }
    return outside;
}

LayerSummary summarise(const Polygon& polygon,
                       const GridGeometry& geometry,
                       ImageView<const float> layer) {
    LayerSummary summary;
    double sum = 0.0;
    summary.outside = cells_in(polygon, geometry, [&](Cell cell) {
        const double value = static_cast<double>(layer.at(cell.ix, cell.iy));
        if (!std::isfinite(value)) {
            ++summary.unknown;
            return;
        }
        const bool first = summary.known == 0;
        summary.min = first ? value : std::min(summary.min, value);
        summary.max = first ? value : std::max(summary.max, value);
        sum += value;
        ++summary.known;
    });
    if (summary.known > 0) summary.mean = sum / static_cast<double>(summary.known);
    return summary;
}

}  // namespace surefoot::grid
