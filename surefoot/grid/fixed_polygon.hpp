// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

namespace surefoot::grid {

/// A point in units of 0.1 mm. Geometry on these is exact: the same answer on every machine.
struct FixedPoint {
    std::int64_t x = 0;
    std::int64_t y = 0;
    friend bool operator==(const FixedPoint&, const FixedPoint&) = default;
};

/// Where the cells of a snapshot lie: cell (ix, iy) covers [origin + i * side, origin + (i+1) *
/// side].
struct FixedGrid {
    std::int64_t origin_x = 0;
    std::int64_t origin_y = 0;
    std::int64_t side = 250;
};

/// Convex polygon, counter-clockwise, of fixed capacity. Coordinates relative to the grid must stay
/// below 2^30 units (107 km), so that cross products fit 64 bits.
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

/// Convex hull of at most 8 points (Andrew's monotone chain, 1979); points on an edge are dropped.
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
    hull.count = static_cast<int>(size > 1 ? size - 1 : size);  // the first point came twice
    hull.count = std::min(hull.count, FixedConvex::kMaxVertices);
    std::copy_n(chain.begin(), hull.count, hull.vertices.begin());
    return hull;
}

/// Whether the open polygon and the open square of cell (ix, iy) overlap (separating axes; touching
/// along an edge is no overlap). `corner` is the polygon relative to the grid's origin.
[[nodiscard]] inline bool overlaps_cell(const FixedConvex& relative,
                                        std::int64_t side,
                                        std::int64_t ix,
                                        std::int64_t iy) noexcept {
    const FixedPoint low{ix * side, iy * side};
    const FixedPoint high{low.x + side, low.y + side};
    for (int i = 0; i < relative.count; ++i) {
        const FixedPoint a = relative.vertices[static_cast<std::size_t>(i)];
        const FixedPoint b = relative.vertices[static_cast<std::size_t>((i + 1) % relative.count)];
        // The corner farthest to the left of a -> b: is even that one not inside?
        const FixedPoint corner{b.y > a.y ? low.x : high.x, b.x > a.x ? high.y : low.y};
        if (cross(a, b, corner) <= 0) return false;
    }
    return true;
}

/// Calls `visit(ix, iy) -> bool` for every cell whose interior the polygon overlaps, rows from the
/// smallest y, until it returns false; cells outside the map are visited too. Returns whether all
/// were visited. A polygon without area visits nothing. Exact: integers only.
template <typename Visitor>
bool for_each_overlapped_cell(const FixedConvex& polygon, const FixedGrid& grid, Visitor&& visit) {
    if (polygon.count < 3 || grid.side <= 0) return true;
    FixedConvex relative = polygon;
    FixedPoint low{INT64_MAX, INT64_MAX};
    FixedPoint high{INT64_MIN, INT64_MIN};
    for (int i = 0; i < relative.count; ++i) {
        FixedPoint& p = relative.vertices[static_cast<std::size_t>(i)];
        p = {p.x - grid.origin_x, p.y - grid.origin_y};
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    const std::int64_t first_x = floor_div(low.x, grid.side);
    const std::int64_t last_x = floor_div(high.x - 1, grid.side);
    const std::int64_t last_y = floor_div(high.y - 1, grid.side);
    for (std::int64_t iy = floor_div(low.y, grid.side); iy <= last_y; ++iy) {
        for (std::int64_t ix = first_x; ix <= last_x; ++ix) {
            if (overlaps_cell(relative, grid.side, ix, iy) && !visit(ix, iy)) return false;
        }
    }
    return true;
}

}  // namespace surefoot::grid
