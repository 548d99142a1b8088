// SPDX-License-Identifier: Apache-2.0
#include "surefoot/grid/fixed_polygon.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "surefoot/core/rng.hpp"

namespace surefoot::grid {
namespace {

/// Area of the polygon clipped to a square (Sutherland and Hodgman): the oracle for "overlaps".
double clipped_area(const FixedConvex& polygon, double x, double y, double side) {
    std::vector<std::pair<double, double>> points;
    for (const FixedPoint& p : polygon.points())
        points.emplace_back(static_cast<double>(p.x), static_cast<double>(p.y));
    const auto clip = [&points](auto inside_by) {
        std::vector<std::pair<double, double>> out;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const auto a = points[i];
            const auto b = points[(i + 1) % points.size()];
            const double da = inside_by(a);
            const double db = inside_by(b);
            if (da >= 0.0) out.push_back(a);
            if ((da < 0.0) != (db < 0.0)) {
                const double s = da / (da - db);
                out.emplace_back(a.first + s * (b.first - a.first),
                                 a.second + s * (b.second - a.second));
            }
        }
        points = std::move(out);
    };
    clip([&](auto p) { return p.first - x; });
    clip([&](auto p) { return x + side - p.first; });
    clip([&](auto p) { return p.second - y; });
    clip([&](auto p) { return y + side - p.second; });
    double doubled = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto& a = points[i];
        const auto& b = points[(i + 1) % points.size()];
        doubled += a.first * b.second - a.second * b.first;
    }
    return doubled / 2.0;
}

FixedConvex random_hull(Rng& rng, std::int64_t reach) {
    std::vector<FixedPoint> points(1 + rng.below(8));
    const auto coordinate = [&] {
        return static_cast<std::int64_t>(rng.below(static_cast<std::uint64_t>(2 * reach + 1))) -
               reach;
    };
    for (FixedPoint& p : points) p = {coordinate(), coordinate()};
    return convex_hull(points);
}

TEST(FixedPolygon, hull_contains_its_points_turns_left_and_repeats_none) {
    Rng rng(3);
    for (int round = 0; round < 2000; ++round) {
        std::vector<FixedPoint> points(1 + rng.below(8));
        for (FixedPoint& p : points)  // few values: many duplicates and collinear triples
            p = {static_cast<std::int64_t>(rng.below(5)), static_cast<std::int64_t>(rng.below(5))};
        const FixedConvex hull = convex_hull(points);
        ASSERT_GE(hull.count, 1);
        const auto at = [&](int i) {
            return hull.vertices[static_cast<std::size_t>(i % hull.count)];
        };
        if (hull.count < 3) continue;
        for (int i = 0; i < hull.count; ++i) {
            EXPECT_GT(cross(at(i), at(i + 1), at(i + 2)), 0) << "round " << round;
            for (const FixedPoint& p : points)
                EXPECT_GE(cross(at(i), at(i + 1), p), 0) << "round " << round;
        }
    }
}

TEST(FixedPolygon, hull_of_few_or_collinear_points_has_no_area) {
    EXPECT_EQ(convex_hull(std::vector<FixedPoint>{}).count, 0);
    EXPECT_EQ(convex_hull(std::vector<FixedPoint>{{1, 1}, {1, 1}}).count, 2);
    const FixedConvex line = convex_hull(std::vector<FixedPoint>{{0, 0}, {2, 2}, {1, 1}});
    int visited = 0;
    for_each_overlapped_cell(line, {0, 0, 1}, [&](auto, auto) { return ++visited > 0; });
    EXPECT_EQ(visited, 0);
}

/// True if the open polygon and the open square of cell (ix, iy) overlap (separating axes; touching
/// along an edge does not count). The oracle for the runs: it tests every axis separately.
bool overlaps_cell(const FixedConvex& relative,
                   std::int64_t side,
                   std::int64_t ix,
                   std::int64_t iy) {
    const FixedPoint low{ix * side, iy * side};
    const FixedPoint high{low.x + side, low.y + side};
    for (int i = 0; i < relative.count; ++i) {
        const FixedPoint a = relative.vertices[static_cast<std::size_t>(i)];
        const FixedPoint b = relative.vertices[static_cast<std::size_t>((i + 1) % relative.count)];
        // Tests the corner farthest to the left of a -> b: if it is not inside, no corner is.
        const FixedPoint corner{b.y > a.y ? low.x : high.x, b.x > a.x ? high.y : low.y};
        if (cross(a, b, corner) <= 0) return false;
    }
    return true;
}

TEST(FixedPolygon, runs_are_the_cells_that_every_axis_says_overlap) {
    Rng rng(12);
    for (int round = 0; round < 20'000; ++round) {
        const FixedConvex small = random_hull(rng, round % 2 == 0 ? 60 : 9000);
        // Nothing overflows at the largest valid coordinates.
        const std::int64_t far =
            round % 3 == 0 ? 0 : (round % 3 == 1 ? 1'000'000'000 : -1'000'000'000);
        FixedConvex hull = small;
        for (FixedPoint& p : hull.vertices) p = {p.x + far, p.y - far};
        const std::int64_t side = round % 2 == 0 ? 7 : 250;
        if (hull.count < 3) continue;
        FixedPoint low = hull.vertices[0];
        FixedPoint high = low;
        for (const FixedPoint& p : hull.points()) {
            low = {std::min(low.x, p.x), std::min(low.y, p.y)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y)};
        }
        const FixedRun within{floor_div(low.x, side), floor_div(high.x - 1, side)};
        for (auto iy = floor_div(low.y, side); iy <= floor_div(high.y - 1, side); ++iy) {
            const FixedRun run = overlapped_run(hull, side, iy, within);
            for (std::int64_t ix = within.first; ix <= within.last; ++ix)
                ASSERT_EQ(ix >= run.first && ix <= run.last, overlaps_cell(hull, side, ix, iy))
                    << "round " << round << " cell " << ix << " " << iy;
        }
    }
}

TEST(FixedPolygon, visits_exactly_the_cells_with_common_area) {
    Rng rng(11);
    // With integer corners up to 60, the smallest area above zero is 1 / (2 * 120^2)^2. This is far
    // above the rounding of doubles.
    constexpr double kNoArea = 1e-9;
    for (int round = 0; round < 800; ++round) {
        const FixedConvex hull = random_hull(rng, 60);
        const FixedGrid grid{-13, 4, static_cast<std::int64_t>(3 + rng.below(20))};
        std::set<std::pair<std::int64_t, std::int64_t>> visited;
        for_each_overlapped_cell(hull, grid, [&](std::int64_t ix, std::int64_t iy) {
            EXPECT_TRUE(visited.insert({ix, iy}).second);
            return true;
        });
        for (std::int64_t iy = -30; iy <= 30; ++iy) {
            for (std::int64_t ix = -30; ix <= 30; ++ix) {
                const double area =
                    clipped_area(hull,
                                 static_cast<double>(grid.origin_x + ix * grid.side),
                                 static_cast<double>(grid.origin_y + iy * grid.side),
                                 static_cast<double>(grid.side));
                EXPECT_EQ(visited.contains({ix, iy}), area > kNoArea)
                    << "round " << round << " cell " << ix << " " << iy << " area " << area;
            }
        }
    }
}

TEST(FixedPolygon, a_box_on_cell_borders_takes_no_neighbour_and_stops_when_told) {
    const FixedConvex box =
        convex_hull(std::vector<FixedPoint>{{250, 250}, {750, 250}, {750, 500}, {250, 500}});
    std::vector<std::pair<std::int64_t, std::int64_t>> visited;
    EXPECT_TRUE(for_each_overlapped_cell(box, {0, 0, 250}, [&](auto ix, auto iy) {
        visited.emplace_back(ix, iy);
        return true;
    }));
    EXPECT_EQ(visited, (decltype(visited){{1, 1}, {2, 1}}));
    int calls = 0;
    EXPECT_FALSE(for_each_overlapped_cell(box, {0, 0, 250}, [&](auto, auto) {
        ++calls;
        return false;
    }));
    EXPECT_EQ(calls, 1);
}

TEST(FixedPolygon, floor_division_rounds_down_on_both_sides_of_zero) {
    EXPECT_EQ(floor_div(7, 3), 2);
    EXPECT_EQ(floor_div(-7, 3), -3);
    EXPECT_EQ(floor_div(-6, 3), -2);
    EXPECT_EQ(floor_div(0, 3), 0);
}

}  // namespace
}  // namespace surefoot::grid
