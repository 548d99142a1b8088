// SPDX-License-Identifier: Apache-2.0
#include "surefoot/grid/polygon.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/grid/fixed_polygon.hpp"

namespace surefoot::grid {
namespace {

/// "0 0, 2 0, 2 1" -> vertices in m.
Polygon polygon_from(const std::string& text) {
    std::vector<Eigen::Vector2d> vertices;
    std::istringstream in(text);
    std::string pair;
    while (std::getline(in, pair, ',')) {
        std::istringstream numbers(pair);
        Eigen::Vector2d v;
        numbers >> v.x() >> v.y();
        vertices.push_back(v);
    }
    return Polygon(vertices);
}

GridGeometry grid_of(int nx, int ny, double res_m, double x_m = 0.0, double y_m = 0.0) {
    return {res_m, nx, ny, {x_m, y_m}};
}

std::set<std::pair<int, int>> cells_of(const Polygon& polygon, const GridGeometry& grid) {
    std::set<std::pair<int, int>> cells;
    cells_in(polygon, grid, [&](Cell c) {
        EXPECT_TRUE(cells.insert({c.ix, c.iy}).second) << "cell visited twice";
    });
    return cells;
}

Polygon random_star(Rng& rng, double reach_m) {
    std::vector<Eigen::Vector2d> vertices;
    const auto n = static_cast<int>(3 + rng.below(8));
    const Eigen::Vector2d center(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0));
    for (int i = 0; i < n; ++i) {
        const double angle = 2.0 * std::numbers::pi * (i + 0.8 * rng.uniform()) / n;
        const double radius_m = rng.uniform(0.1, 1.0) * reach_m;
        vertices.push_back(center + radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
    return Polygon(vertices);
}

TEST(Polygon, degenerate_ones_contain_nothing) {
    const GridGeometry grid = grid_of(4, 4, 1.0);
    for (const char* text : {"", "1 1", "0 0, 2 2", "0 0, 4 0, nan 4", "0 0, inf 0, 0 2"}) {
        const Polygon polygon = polygon_from(text);
        EXPECT_FALSE(polygon.contains(1.0, 1.0)) << text;
        EXPECT_TRUE(cells_of(polygon, grid).empty()) << text;
    }
    EXPECT_TRUE(cells_of(polygon_from("1 1, 1 1, 1 1, 1 1"), grid).empty());
    EXPECT_TRUE(cells_of(polygon_from("0 0, 1 1, 2 2, 3 3"), grid).empty());
    EXPECT_FALSE(polygon_from("0 0, 4 0, 4 4").contains(std::nan(""), 1.0));
    EXPECT_FALSE(polygon_from("0 0, 4 0, 4 4").contains(3.0, std::nan("")));
}

TEST(Polygon, literal_triangle_and_notch) {
    const GridGeometry grid = grid_of(4, 4, 1.0);
    // Centres at .5: the triangle holds those below its diagonal.
    const std::set<std::pair<int, int>> triangle{{1, 0}, {2, 0}, {3, 0}, {2, 1}, {3, 1}, {3, 2}};
    EXPECT_EQ(cells_of(polygon_from("0.2 0, 4 0, 4 3.8"), grid), triangle);
    // A concave "C": the notch is not inside.
    const Polygon notch = polygon_from("0 0, 4 0, 4 1, 1 1, 1 3, 4 3, 4 4, 0 4");
    EXPECT_FALSE(notch.contains(2.5, 2.0));
    EXPECT_TRUE(notch.contains(0.5, 2.0));
    EXPECT_EQ(cells_of(notch, grid).size(), 4U + 1U + 1U + 4U);
}

TEST(Polygon, neighbours_share_no_cell_and_lose_none) {
    const GridGeometry grid = grid_of(8, 8, 0.5);
    // The common edge runs exactly through cell centres.
    const auto left = cells_of(polygon_from("0 0, 1.75 0, 1.75 4, 0 4"), grid);
    const auto right = cells_of(polygon_from("1.75 0, 4 0, 4 4, 1.75 4"), grid);
    EXPECT_EQ(left.size() + right.size(), 64U);
    for (const auto& cell : left) EXPECT_FALSE(right.contains(cell));
}

TEST(Polygon, cells_match_the_point_test_of_every_centre) {
    Rng rng(7);
    for (int round = 0; round < 300; ++round) {
        const GridGeometry grid = grid_of(37, 29, 0.05, -0.9, -0.7);
        const Polygon polygon = random_star(rng, 1.2);
        std::set<std::pair<int, int>> expected;
        std::int64_t outside = 0;
        for (int iy = -80; iy < 120; ++iy) {
            for (int ix = -80; ix < 120; ++ix) {
                const Eigen::Vector2d c = grid.center_m({ix, iy});
                if (!polygon.contains(c.x(), c.y())) continue;
                if (grid.contains({ix, iy}))
                    expected.insert({ix, iy});
                else
                    ++outside;
            }
        }
        EXPECT_EQ(cells_of(polygon, grid), expected) << "round " << round;
        EXPECT_EQ(cells_in(polygon, grid, [](Cell) {}), outside) << "round " << round;
    }
}

TEST(Polygon, summary_finds_all_in_one_pass_and_counts_what_is_missing) {
    const GridGeometry grid = grid_of(4, 2, 1.0);
    Layer layer(4, 2, 1.0F);
    layer.at(0, 0) = -3.0F;
    layer.at(1, 0) = 5.0F;
    layer.at(2, 0) = std::nanf("");
    const LayerSummary all =
        summarise(polygon_from("0 0, 4 0, 4 2, 0 2"), grid, std::as_const(layer).view());
    EXPECT_EQ(all.known, 7);
    EXPECT_EQ(all.unknown, 1);
    EXPECT_EQ(all.outside, 0);
    EXPECT_EQ(all.min, -3.0);
    EXPECT_EQ(all.max, 5.0);
    EXPECT_EQ(all.mean, 1.0);
    EXPECT_FALSE(all.all_known());
    const LayerSummary half =
        summarise(polygon_from("3 0, 5 0, 5 2, 3 2"), grid, std::as_const(layer).view());
    EXPECT_EQ(half.known, 2);
    EXPECT_EQ(half.outside, 2);
    EXPECT_FALSE(half.all_known());
    const LayerSummary beyond =
        summarise(polygon_from("9 9, 11 9, 11 11"), grid, std::as_const(layer).view());
    EXPECT_EQ(beyond.known, 0);
    EXPECT_TRUE(std::isnan(beyond.mean));
    EXPECT_FALSE(beyond.all_known());
}

// ---- the exact twin -----------------------------------------------------------------------------

/// Area of the polygon clipped to a square (Sutherland and Hodgman): the oracle of "overlaps".
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

TEST(FixedPolygon, visits_exactly_the_cells_with_common_area) {
    Rng rng(11);
    // Integer corners up to 60: an area that is not zero is at least 1 / (2 * 120^2)^2, far above
    // the rounding of doubles.
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
