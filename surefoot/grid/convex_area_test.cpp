// SPDX-License-Identifier: Apache-2.0
#include "surefoot/grid/convex_area.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::grid {
namespace {

using Points = std::vector<Eigen::Vector2d>;
using Cells = std::set<std::pair<std::int64_t, std::int64_t>>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Unit cells: one metre is one cell.
const GridGeometry kUnit{1.0, 8, 8, {0.0, 0.0}};

Cells cells_of(const ConvexArea& area) {
    Cells cells;
    for (auto iy = area.first_row(); iy < area.end_row(); ++iy) {
        const CellRun run = area.row(iy);
        EXPECT_EQ(run.iy, iy);
        EXPECT_GT(run.cells(), 0) << "row " << iy;
        for (auto ix = run.first; ix < run.end; ++ix) cells.insert({ix, iy});
    }
    return cells;
}

double distance_to_segment(const Eigen::Vector2d& p,
                           const Eigen::Vector2d& a,
                           const Eigen::Vector2d& b) {
    const Eigen::Vector2d along = b - a;
    const double length2 = along.squaredNorm();
    const double s = length2 > 0.0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
    return (p - (a + s * along)).norm();
}

/// Distance of two hulls, or minus their overlap depth. Uses the separating axes of all pairs of
/// points; they include the edges of both hulls, and no other axis is needed.
double separation(const Points& a, const Points& b) {
    double widest_gap = -kInfinity;
    const auto try_axis = [&](Eigen::Vector2d axis) {
        if (axis.squaredNorm() == 0.0) return;
        axis.normalize();
        const auto extent = [&axis](const Points& points) {
            double low = kInfinity;
            double high = -kInfinity;
            for (const auto& p : points) {
                low = std::min(low, axis.dot(p));
                high = std::max(high, axis.dot(p));
            }
            return std::pair{low, high};
        };
        const auto [a_low, a_high] = extent(a);
        const auto [b_low, b_high] = extent(b);
        widest_gap = std::max({widest_gap, b_low - a_high, a_low - b_high});
    };
    for (const Points* points : {&a, &b}) {
        for (const auto& p : *points)
            for (const auto& q : *points) try_axis({p.y() - q.y(), q.x() - p.x()});
    }
    if (a.size() == 2 && widest_gap <= 0.0) try_axis(a[1] - a[0]);
    if (widest_gap <= 0.0) return widest_gap;
    double nearest = kInfinity;  // separate hulls: the nearest points are a corner and a side
    for (const auto& [from, to] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
        for (const auto& p : *from)
            for (const auto& q : *to)
                for (const auto& r : *to) nearest = std::min(nearest, distance_to_segment(p, q, r));
    }
    return nearest;
}

Points corners(double ix, double iy) {
    return {{ix, iy}, {ix + 1, iy}, {ix + 1, iy + 1}, {ix, iy + 1}};
}

TEST(ConvexArea, literal_circle_touches_more_cells_than_it_holds_centres) {
    // Radius 1.2 around the common corner of four cells covers these and the next cells on each
    // side.
    const Cells around = cells_of({Points{{4, 4}}, 1.2, kUnit});
    EXPECT_EQ(around.size(), 12U);
    EXPECT_TRUE(around.contains({2, 4}));
    EXPECT_FALSE(around.contains({2, 2}));
    // An area smaller than a cell covers the cell around it.
    EXPECT_EQ(cells_of({Points{{2.5, 3.5}}, 0.1, kUnit}), (Cells{{2, 3}}));
    EXPECT_EQ(cells_of({Points{{2.5, 3.5}}, 1e-9, kUnit}), (Cells{{2, 3}}));
}

TEST(ConvexArea, box_on_cell_borders_takes_no_neighbour_whatever_the_rounding) {
    const Points box{{1, 1}, {3, 1}, {3, 2}, {1, 2}};
    EXPECT_EQ(cells_of({box, 0.0, kUnit}), (Cells{{1, 1}, {2, 1}}));
    // A double cannot hold 0.025 exactly: its multiples lie on both sides of the border.
    for (int shift = -40; shift < 40; ++shift) {
        const GridGeometry fine{0.025, 240, 240, {-3.0 + 0.025 * shift, -3.0}};
        Points foot;
        for (const auto& [x_m, y_m] : {std::pair{-0.2, -0.1}, {0.2, -0.1}, {0.2, 0.1}, {-0.2, 0.1}})
            foot.push_back({x_m, y_m});
        EXPECT_EQ(cells_of({foot, 0.0, fine}).size(), 16U * 8U) << "shift " << shift;
    }
}

TEST(ConvexArea, any_order_and_repeated_points_are_the_same_area) {
    const Points around{{0.3, 0.2}, {5.1, 1.4}, {6.2, 4.4}, {2.0, 5.5}};
    const Points mixed{{6.2, 4.4}, {0.3, 0.2}, {3.0, 3.0}, {2.0, 5.5}, {5.1, 1.4}, {0.3, 0.2}};
    EXPECT_EQ(cells_of({mixed, 0.7, kUnit}), cells_of({around, 0.7, kUnit}));
    EXPECT_EQ(cells_of({Points{{2.5, 2.5}, {2.5, 2.5}}, 1.0, kUnit}),
              cells_of({Points{{2.5, 2.5}}, 1.0, kUnit}));
}

TEST(ConvexArea, overlaps_exactly_the_cells_nearer_than_its_radius) {
    // A sliver moves the ends of a row by 1e-5 cells. Hulls of random points rarely have corners
    // sharper than 1/20 of a right angle, so the ends move by less than this limit.
    constexpr double kUnsure_cells = 40.0 * ConvexArea::kSliver_cells;
    constexpr double kRounding_cells = 1e-9;
    Rng rng(21);
    int unsure = 0;
    int judged = 0;
    for (int round = 0; round < 400; ++round) {
        Points points(1 + rng.below(7));
        for (auto& p : points) p = {rng.uniform(-3.0, 11.0), rng.uniform(-3.0, 11.0)};
        // A polygon without a radius must have an area.
        const bool grown = points.size() < 3 || rng.below(2) == 0;
        const double radius = grown ? rng.uniform(0.05, 3.0) : 0.0;
        const Cells found = cells_of({points, radius, kUnit});
        for (int iy = -8; iy < 16; ++iy) {
            for (int ix = -8; ix < 16; ++ix) {
                const double apart = separation(points, corners(ix, iy)) - radius;
                ++judged;
                if (apart > -kUnsure_cells && apart < kRounding_cells) {
                    ++unsure;
                    continue;
                }
                ASSERT_EQ(found.contains({ix, iy}), apart < 0.0)
                    << "round " << round << " cell " << ix << " " << iy << " apart " << apart;
            }
        }
    }
    EXPECT_LT(unsure, judged / 1000);
}

TEST(ConvexArea, is_empty_for_what_cannot_be_counted) {
    const Points point{{1.0, 1.0}};
    EXPECT_FALSE(ConvexArea(point, 0.5, kUnit).empty());
    EXPECT_TRUE(ConvexArea(Points{}, 0.5, kUnit).empty());
    EXPECT_TRUE(ConvexArea(Points(33, {1.0, 1.0}), 0.5, kUnit).empty());
    for (const double bad : {kNan, kInfinity, -kInfinity, 1e30, -1e30}) {
        EXPECT_TRUE(ConvexArea(Points{{bad, 1.0}}, 0.5, kUnit).empty()) << bad;
        EXPECT_TRUE(ConvexArea(Points{{1.0, 1.0}, {1.0, bad}}, 0.5, kUnit).empty()) << bad;
        EXPECT_TRUE(ConvexArea(point, bad, kUnit).empty()) << bad;
        EXPECT_TRUE(ConvexArea(point, 0.5, {1.0, 8, 8, {0.0, bad}}).empty()) << bad;
    }
    for (const double bad : {kNan, kInfinity, 0.0, -1.0})
        EXPECT_TRUE(ConvexArea(point, 0.5, {bad, 8, 8, {0.0, 0.0}}).empty()) << bad;
    EXPECT_TRUE(ConvexArea(point, -0.5, kUnit).empty());
}

TEST(CellRun, is_clipped_to_the_grid_or_to_nothing) {
    const GridGeometry grid{1.0, 4, 3, {0.0, 0.0}};
    EXPECT_EQ((CellRun{1, -2, 9}).clipped(grid), (CellRun{1, 0, 4}));
    EXPECT_EQ((CellRun{1, 1, 3}).clipped(grid), (CellRun{1, 1, 3}));
    for (const CellRun& beyond : {CellRun{-1, 0, 4}, {3, 0, 4}, {1, -5, 0}, {1, 4, 9}, {1, 2, 2}})
        EXPECT_EQ(beyond.clipped(grid).cells(), 0) << beyond.iy << " " << beyond.first;
}

}  // namespace
}  // namespace surefoot::grid
