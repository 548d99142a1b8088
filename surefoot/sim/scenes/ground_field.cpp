// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/ground_field.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "surefoot/core/checked_index.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector2d;

/// Tolerance of heights. A surface is buried if another solid begins at the surface or below and
/// ends above the surface.
constexpr double kTouch_m = 1e-9;
/// Queries of tiles are slightly wider than the tiles, so that a solid that ends on a tile border
/// is not lost.
constexpr double kTileMargin_m = 1e-5;
constexpr int kTileSamples = 16;
/// Tolerance of sample indices. Samples on the border of an area belong to the area.
constexpr double kIndexRounding = 1e-6;

std::optional<Column> column_of(const Scene& scene, int primitive, const Vector2d& p_m) {
    return std::visit([&](const auto& shape) { return shape.column(p_m.x(), p_m.y()); },
                      scene.primitive(primitive));
}

bool buried(double z_m, std::span<const Column> columns) {
    return std::any_of(columns.begin(), columns.end(), [&](const Column& column) {
        return column.bottom_m <= z_m + kTouch_m && column.top_m > z_m + kTouch_m;
    });
}

GroundSample read_columns(std::span<const Column> columns, double highest_m) {
    GroundSample sample;
    double above_m = std::numeric_limits<double>::infinity();
    for (const Column& column : columns) {
        const bool high = column.top_m > highest_m;
        if (high) {
            sample.underside_m = std::min(sample.underside_m, column.bottom_m);
            sample.top_m = std::max(sample.top_m, column.top_m);
        }
        if (columns.size() > 1 && buried(column.top_m, columns)) continue;
        if (high) {
            above_m = std::min(above_m, column.top_m);
        } else if (!(sample.ground_m >= column.top_m)) {
            sample.ground_m = column.top_m;
        }
    }
    if (std::isnan(sample.ground_m) && std::isfinite(above_m)) sample.ground_m = above_m;
    return sample;
}

GroundSample sample_among(const Scene& scene,
                          std::span<const int> primitives,
                          const Vector2d& p_m,
                          double highest_m,
                          std::vector<Column>& columns) {
    if (primitives.size() == 1) {
        const auto column = column_of(scene, primitives.front(), p_m);
        return column ? read_columns({&*column, 1}, highest_m) : GroundSample{};
    }
    columns.clear();
    for (const int k : primitives) {
        if (const auto column = column_of(scene, k, p_m)) columns.push_back(*column);
    }
    return read_columns(columns, highest_m);
}

/// World rectangle around a tile of the field.
Rect around(const PlanarPose& T_world_field, const GroundField::Range& tile) {
    Rect box{Vector2d::Constant(std::numeric_limits<double>::infinity()),
             Vector2d::Constant(-std::numeric_limits<double>::infinity())};
    for (const int i : {tile.min_i, tile.max_i}) {
        for (const int j : {tile.min_j, tile.max_j}) {
            const Vector2d corner_m = T_world_field * GroundField::point_m(i, j);
            box.min_m = box.min_m.cwiseMin(corner_m);
            box.max_m = box.max_m.cwiseMax(corner_m);
        }
    }
    return {box.min_m.array() - kTileMargin_m, box.max_m.array() + kTileMargin_m};
}

std::vector<int> primitives_over(const Scene& scene, std::span<const int> among, const Rect& box) {
    std::vector<int> found;
    for (const int k : among) {
        const bool over =
            std::visit([&](const auto& shape) { return shape.highest_over(box).has_value(); },
                       scene.primitive(k));
        if (over) found.push_back(k);
    }
    return found;
}

std::vector<int> all_primitives(const Scene& scene) {
    std::vector<int> all(static_cast<std::size_t>(scene.primitives()));
    std::iota(all.begin(), all.end(), 0);
    return all;
}

/// Index of a sample, limited to 2^28 (1342 km from the origin).
int index_of(double samples) {
    constexpr int kFarthest = 1 << 28;
    return clamped_integer<int>(samples, -kFarthest, kFarthest);
}

}  // namespace

GroundSample sample_ground(
    const Scene& scene, double x_m, double y_m, double level_m, double reach_m) {
    std::vector<Column> columns;
    return sample_among(scene, all_primitives(scene), {x_m, y_m}, level_m + reach_m, columns);
}

GroundField::GroundField(const Scene& scene,
                         const PlanarPose& T_world_field,
                         const Rect& region,
                         const LevelPlane& level,
                         double reach_m)
    : T_world_field_(T_world_field) {
    range_ = {index_of(std::floor(region.min_m.x() / kSpacing_m)),
              index_of(std::ceil(region.max_m.x() / kSpacing_m)),
              index_of(std::floor(region.min_m.y() / kSpacing_m)),
              index_of(std::ceil(region.max_m.y() / kSpacing_m))};
    samples_.resize(static_cast<std::size_t>(width()) *
                    static_cast<std::size_t>(range_.max_j - range_.min_j + 1));
    const auto near = primitives_over(scene, all_primitives(scene), around(T_world_field, range_));
    std::vector<Column> columns;
    for (int j0 = range_.min_j; j0 <= range_.max_j; j0 += kTileSamples) {
        for (int i0 = range_.min_i; i0 <= range_.max_i; i0 += kTileSamples) {
            const Range tile{i0,
                             std::min(i0 + kTileSamples - 1, range_.max_i),
                             j0,
                             std::min(j0 + kTileSamples - 1, range_.max_j)};
            const auto here = primitives_over(scene, near, around(T_world_field, tile));
            for (int j = tile.min_j; j <= tile.max_j; ++j) {
                for (int i = tile.min_i; i <= tile.max_i; ++i) {
                    const Vector2d p_field = point_m(i, j);
                    samples_[index(i, j)] = sample_among(
                        scene, here, T_world_field * p_field, level.at(p_field) + reach_m, columns);
                }
            }
            tiles_.push_back(summary(tile));
        }
    }
}

GroundField::Tile GroundField::summary(const Range& range) const {
    Tile tile;
    tile.range = range;
    for (int j = range.min_j; j <= range.max_j; ++j) {
        for (int i = range.min_i; i <= range.max_i; ++i) {
            const GroundSample& sample = at(i, j);
            const double low_m = std::isnan(sample.ground_m)
                                     ? -std::numeric_limits<double>::infinity()
                                     : sample.ground_m;
            tile.lowest_ground_m = std::min(tile.lowest_ground_m, low_m);
            tile.highest_ground_m = std::max(tile.highest_ground_m, low_m);
            tile.lowest_underside_m = std::min(tile.lowest_underside_m, sample.underside_m);
            tile.highest_top_m = std::max(tile.highest_top_m, sample.top_m);
        }
    }
    return tile;
}

GroundField::Range GroundField::range_of(const Rect& area) const {
    const auto first = [](double at_m) {
        return index_of(std::ceil(at_m / kSpacing_m - kIndexRounding));
    };
    const auto last = [](double at_m) {
        return index_of(std::floor(at_m / kSpacing_m + kIndexRounding));
    };
    return {std::max(first(area.min_m.x()), range_.min_i),
            std::min(last(area.max_m.x()), range_.max_i),
            std::max(first(area.min_m.y()), range_.min_j),
            std::min(last(area.max_m.y()), range_.max_j)};
}

std::vector<char> GroundField::reached_from(const std::vector<Range>& seeds, double jump_m) const {
    double lowest_m = std::numeric_limits<double>::infinity();
    double highest_m = -lowest_m;
    for (const Tile& tile : tiles_) {
        lowest_m = std::min(lowest_m, tile.lowest_ground_m);
        highest_m = std::max(highest_m, tile.highest_ground_m);
    }
    // Without any jump all samples are joined. A void has height -inf, so it counts as a jump.
    if (highest_m - lowest_m <= jump_m) return std::vector<char>(samples_.size(), 1);

    std::vector<char> reached(samples_.size(), 0);
    std::vector<std::pair<int, int>> open;
    const auto visit = [&](int i, int j) {
        char& mark = reached[index(i, j)];
        if (mark != 0 || std::isnan(at(i, j).ground_m)) return;
        mark = 1;
        open.emplace_back(i, j);
    };
    for (const Range& seed : seeds) {
        for (int j = seed.min_j; j <= seed.max_j; ++j) {
            for (int i = seed.min_i; i <= seed.max_i; ++i) visit(i, j);
        }
    }
    while (!open.empty()) {
        const auto [i, j] = open.back();
        open.pop_back();
        const double here_m = at(i, j).ground_m;
        for (const auto& [di, dj] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
            const int ni = i + di;
            const int nj = j + dj;
            if (ni < range_.min_i || ni > range_.max_i || nj < range_.min_j || nj > range_.max_j)
                continue;
            if (std::abs(at(ni, nj).ground_m - here_m) <= jump_m) visit(ni, nj);
        }
    }
    return reached;
}

}  // namespace surefoot::sim
