// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

namespace surefoot::grid {

/// A point in units of 0.1 mm. Geometry on such points is exact and equal on every computer.
struct FixedPoint {
    std::int64_t x = 0;
    std::int64_t y = 0;
    friend bool operator==(const FixedPoint&, const FixedPoint&) = default;
};

/// Position of the cells of a snapshot [0.1 mm]: cell (ix, iy) covers [origin + i * side, origin +
/// (i+1) * side].
struct FixedGrid {
    std::int64_t origin_x = 0;
    std::int64_t origin_y = 0;
    std::int64_t side = 250;
};

/// Convex polygon, counter-clockwise, of fixed capacity. Coordinates relative to the grid must stay
/// below 2^30 units (107 km), so that cross products fit into 64 bits.
struct FixedConvex {
    static constexpr int kMaxVertices = 8;
    std::array<FixedPoint, kMaxVertices> vertices{};
    int count = 0;

    [[nodiscard]] std::span<const FixedPoint> points() const noexcept {
        return {vertices.data(), static_cast<std::size_t>(count)};
    }
};

/// Twice the signed area of the triangle (a, b, c): positive when c lies left of a -> b.
[[nodiscard]] constexpr std::int64_t cross(FixedPoint a, FixedPoint b, FixedPoint c) noexcept {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Largest integer <= a / b, b > 0.
[[nodiscard]] constexpr std::int64_t floor_div(std::int64_t a, std::int64_t b) noexcept {
    const std::int64_t quotient = a / b;
    return quotient - (a % b < 0 ? 1 : 0);
}

/// a / b, rounded to the nearest integer; halves upward. b > 0.
[[nodiscard]] constexpr std::int64_t rounded_div(std::int64_t a, std::int64_t b) noexcept {
    return floor_div(2 * a + b, 2 * b);
}

[[nodiscard]] constexpr std::int64_t magnitude(std::int64_t x) noexcept {
    return x < 0 ? -x : x;
}

/// Convex hull of at most 8 points (Andrew's monotone chain, 1979). Drops points on an edge.
[[nodiscard]] inline FixedConvex convex_hull(std::span<const FixedPoint> points) noexcept {
    std::array<FixedPoint, FixedConvex::kMaxVertices> sorted{};
    const auto n = std::min(points.size(), sorted.size());
    std::copy_n(points.begin(), n, sorted.begin());
    std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(n), [](auto a, auto b) {
        return a.x != b.x ? a.x < b.x : a.y < b.y;
    });
    std::array<FixedPoint, 2 * FixedConvex::kMaxVertices> chain{};
    std::size_t size = 0;
    const auto extend = [&](FixedPoint point, std::size_t base) {
        while (size >= base + 2 && cross(chain[size - 2], chain[size - 1], point) <= 0) --size;
        chain[size++] = point;
    };
    for (std::size_t i = 0; i < n; ++i) extend(sorted[i], 0);
    const std::size_t lower = size - (size > 0 ? 1 : 0);  // the last point starts the upper chain
    for (std::size_t i = n; i-- > 1;) extend(sorted[i - 1], lower);
    FixedConvex hull;
    hull.count = static_cast<int>(size > 1 ? size - 1 : size);  // the first point is also the last
    hull.count = std::min(hull.count, FixedConvex::kMaxVertices);
    std::copy_n(chain.begin(), hull.count, hull.vertices.begin());
    return hull;
}

/// A run of cells of one row; empty when last < first.
struct FixedRun {
    std::int64_t first = 0;
    std::int64_t last = -1;

    [[nodiscard]] constexpr bool contains(std::int64_t i) const noexcept {
        return i >= first && i <= last;
    }
};

/// Returns the cells of row `iy`, limited to `within`, whose open square overlaps the open polygon
/// (separating axes; touching an edge does not count). They form one run, because the polygon is
/// convex. Exact; costs two divisions per edge that is not parallel to the row. `relative`: a
/// polygon with an area, relative to the grid's origin; `iy` and `within` lie in its bounding box.
[[nodiscard]] inline FixedRun overlapped_run(const FixedConvex& relative,
                                             std::int64_t side,
                                             std::int64_t iy,
                                             FixedRun within) noexcept {
    const std::int64_t low_y = iy * side;
    for (int i = 0; i < relative.count; ++i) {
        const FixedPoint a = relative.vertices[static_cast<std::size_t>(i)];
        const FixedPoint b = relative.vertices[static_cast<std::size_t>((i + 1) % relative.count)];
        // The cell corner farthest left of a -> b must have dx * (y - a.y) - dy * (x - a.x) > 0.
        const std::int64_t dy = b.y - a.y;
        const std::int64_t y = b.x > a.x ? low_y + side : low_y;
        const std::int64_t product = (b.x - a.x) * (y - a.y);
        if (dy > 0) {  // x = ix * side < a.x + product / dy
            const std::int64_t x = a.x + floor_div(product - 1, dy);
            within.last = std::min(within.last, floor_div(x, side));
        } else if (dy < 0) {  // x = (ix + 1) * side > a.x + (-product) / (-dy)
            const std::int64_t x = a.x + floor_div(-product, -dy) + 1;
            within.first = std::max(within.first, floor_div(x + side - 1, side) - 1);
        } else if (product <= 0) {
            return {};
        }
    }
    return within;
}

/// A polygon as runs of cells, in exact integers. A polygon without area has no rows.
class RowRuns {
  public:
    RowRuns() = default;
    RowRuns(const FixedConvex& polygon, const FixedGrid& grid) noexcept
        : relative_(polygon), side_(grid.side) {
        if (polygon.count < 3 || grid.side <= 0) return;
        FixedPoint low{INT64_MAX, INT64_MAX};
        FixedPoint high{INT64_MIN, INT64_MIN};
        for (int i = 0; i < relative_.count; ++i) {
            FixedPoint& p = relative_.vertices[static_cast<std::size_t>(i)];
            p = {p.x - grid.origin_x, p.y - grid.origin_y};
            low = {std::min(low.x, p.x), std::min(low.y, p.y)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y)};
        }
        columns_ = {floor_div(low.x, side_), floor_div(high.x - 1, side_)};
        rows_ = {floor_div(low.y, side_), floor_div(high.y - 1, side_)};
    }
    [[nodiscard]] FixedRun rows() const noexcept { return rows_; }
    [[nodiscard]] FixedRun columns() const noexcept { return columns_; }
    /// Returns the cells of row `iy` whose interior overlaps the polygon. Every `iy` is valid.
    [[nodiscard]] FixedRun run(std::int64_t iy) const noexcept {
        if (iy < rows_.first || iy > rows_.last) return {};
        return overlapped_run(relative_, side_, iy, columns_);
    }

  private:
    FixedConvex relative_;  ///< the polygon, relative to the grid's origin
    std::int64_t side_ = 1;
    FixedRun rows_;
    FixedRun columns_;
};

/// Calls `visit(ix, iy) -> bool` for every cell whose interior overlaps the polygon, also outside
/// the map. Starts at the smallest y and stops when `visit` returns false. Returns true if it
/// visited all cells. A polygon without area has no cells.
template <typename Visitor>
bool for_each_overlapped_cell(const FixedConvex& polygon, const FixedGrid& grid, Visitor&& visit) {
    const RowRuns area(polygon, grid);
    for (std::int64_t iy = area.rows().first; iy <= area.rows().last; ++iy) {
        const FixedRun run = area.run(iy);
        for (std::int64_t ix = run.first; ix <= run.last; ++ix) {
            if (!visit(ix, iy)) return false;
        }
    }
    return true;
}

}  // namespace surefoot::grid
