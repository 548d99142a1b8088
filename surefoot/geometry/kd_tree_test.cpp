// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/kd_tree.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/geometry/spatial_order.hpp"
#include "surefoot/geometry/surface_normal.hpp"

namespace surefoot::geometry {
namespace {

using Eigen::Vector3f;
using Points = std::vector<Vector3f>;

/// Relative rounding limit of squared distances.
constexpr float kRounding = 1e-6F;

Vector3f random_point(Rng& rng, double side_m) {
    const auto c = [&] { return static_cast<float>(rng.uniform(-side_m, side_m)); };
    return {c(), c(), c()};
}

/// Typical content of scans: a floor, a wall, scattered points and copies of points.
Points scan(std::size_t count, std::uint64_t seed) {
    Rng rng(seed);
    Points points_m;
    while (points_m.size() < count) {
        Vector3f p_m = random_point(rng, 2.0);
        const std::uint64_t kind = rng.below(8);
        if (kind < 4) p_m.z() = 0.0F;
        if (kind >= 4 && kind < 6) p_m.x() = 2.0F;
        if (kind == 6 && !points_m.empty()) p_m = points_m[rng.below(points_m.size())];
        points_m.push_back(p_m);
    }
    return points_m;
}

std::vector<float> sorted_sq_distances(const Points& points_m, const Vector3f& query_m) {
    std::vector<float> sq;
    for (const Vector3f& p_m : points_m) sq.push_back((p_m - query_m).squaredNorm());
    std::sort(sq.begin(), sq.end());
    return sq;
}

void expect_as_far(float found, float expected, const char* what) {
    EXPECT_NEAR(found, expected, kRounding * expected) << what;
}

TEST(KdTree, FindsTheNearestOfEveryNumberOfPoints) {
    Rng rng(1);
    for (const std::size_t count : {1U, 2U, 3U, 11U, 12U, 13U, 25U, 100U, 777U, 5000U}) {
        const Points points_m = scan(count, count);
        const KdTree tree(points_m);
        ASSERT_EQ(tree.points_m().size(), count);
        Neighbour last;
        for (int i = 0; i < 200; ++i) {
            const Vector3f query_m = i % 4 == 0 ? points_m[rng.below(count)]
                                                : random_point(rng, i % 4 == 1 ? 20.0 : 2.5);
            const std::vector<float> sq = sorted_sq_distances(points_m, query_m);
            const Neighbour found = tree.nearest(query_m);
            expect_as_far(found.sq_distance_m2, sq.front(), "nearest");
            EXPECT_EQ(tree.neighbour(query_m, found.index).sq_distance_m2, found.sq_distance_m2);
            // The start must not change the result.
            if (i > 0) {
                expect_as_far(
                    tree.nearest(query_m, tree.neighbour(query_m, last.index)).sq_distance_m2,
                    sq.front(),
                    "with a start");
            }
            last = found;
            std::vector<Neighbour> some(7);
            const std::size_t there = tree.nearest(query_m, some);
            ASSERT_EQ(there, std::min<std::size_t>(7, count));
            for (std::size_t k = 0; k < there; ++k)
                expect_as_far(some[k].sq_distance_m2, sq[k], "one of seven");
        }
    }
}

TEST(KdTree, HoldsEveryPointOnceAndFindsIt) {
    const Points points_m = scan(3000, 7);
    const KdTree tree(points_m);
    const auto less = [](const Vector3f& a, const Vector3f& b) {
        return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    };
    Points before = points_m;
    Points after(tree.points_m().begin(), tree.points_m().end());
    std::sort(before.begin(), before.end(), less);
    std::sort(after.begin(), after.end(), less);
    EXPECT_EQ(before, after);
    for (const Vector3f& p_m : points_m) EXPECT_EQ(tree.points_m()[tree.find(p_m)], p_m);
    EXPECT_EQ(tree.find(points_m[0] + Vector3f(1e-5F, 0.0F, 0.0F)), Neighbour::kNone);
}

TEST(KdTree, EmptyAndOnePlaceAThousandTimes) {
    const KdTree none{Points{}};
    EXPECT_TRUE(none.empty());
    EXPECT_EQ(none.nearest({1.0F, 2.0F, 3.0F}).index, Neighbour::kNone);
    EXPECT_EQ(none.find({1.0F, 2.0F, 3.0F}), Neighbour::kNone);
    std::vector<Neighbour> found(3);
    EXPECT_EQ(none.nearest({1.0F, 2.0F, 3.0F}, found), 0U);
    none.runs_near_ball({0.0F, 0.0F, 0.0F}, 1e9F, [](auto, auto) { FAIL() << "nothing is there"; });

    const KdTree same(Points(1000, Vector3f(1.0F, 2.0F, 3.0F)));
    EXPECT_EQ(same.nearest({1.0F, 2.0F, 4.0F}).sq_distance_m2, 1.0F);
    EXPECT_EQ(same.nearest({1.0F, 2.0F, 3.0F}, found), 3U);
    EXPECT_EQ(found.back().sq_distance_m2, 0.0F);
    EXPECT_NE(same.find({1.0F, 2.0F, 3.0F}), Neighbour::kNone);
}

TEST(KdTree, AnyExecutorBuildsTheSameTree) {
    const Points points_m = scan(200000, 3);
    const KdTree one(points_m);
    Backwards backwards;
    Threads threads(3);
    for (Executor* executor :
         {static_cast<Executor*>(&backwards), static_cast<Executor*>(&threads)}) {
        const KdTree other(points_m, *executor);
        ASSERT_TRUE(
            std::equal(one.points_m().begin(), one.points_m().end(), other.points_m().begin()));
    }
}

std::size_t count_if_inside(std::span<const Vector3f> run, const Cylinder& c) {
    return static_cast<std::size_t>(std::count_if(run.begin(), run.end(), [&](const Vector3f& p_m) {
        const Vector3f to_m = p_m - c.middle_m;
        const float along_m = to_m.dot(c.axis);
        return std::abs(along_m) <= c.half_length_m &&
               (to_m - along_m * c.axis).norm() <= c.radius_m;
    }));
}

TEST(KdTree, RunsNearABallOrCylinderHoldAllOfItAndLittleElse) {
    const Points points_m = scan(20000, 5);
    const KdTree tree(points_m);
    Rng rng(6);
    std::size_t looked_at = 0;
    std::size_t inside = 0;
    for (int i = 0; i < 300; ++i) {
        Cylinder c;
        c.middle_m = points_m[rng.below(points_m.size())];
        c.axis = i % 3 == 0 ? Vector3f(Vector3f::UnitZ()) : random_point(rng, 1.0).normalized();
        c.radius_m = static_cast<float>(rng.uniform(0.02, 0.3));
        c.half_length_m = static_cast<float>(rng.uniform(0.02, 0.5));
        std::size_t found = 0;
        tree.runs_near_cylinder(c, [&](std::span<const Vector3f> run, std::size_t copies) {
            ASSERT_EQ(copies, 1U);
            looked_at += run.size();
            found += count_if_inside(run, c);
        });
        EXPECT_EQ(found, count_if_inside(points_m, c)) << "cylinder " << i;
        inside += found;

        const auto in_ball = [&](std::span<const Vector3f> run) {
            return std::count_if(run.begin(), run.end(), [&](const Vector3f& p_m) {
                return (p_m - c.middle_m).norm() <= c.radius_m;
            });
        };
        std::ptrdiff_t in_runs = 0;
        tree.runs_near_ball(c.middle_m, c.radius_m, [&](std::span<const Vector3f> run, auto) {
            in_runs += in_ball(run);
        });
        EXPECT_EQ(in_runs, in_ball(points_m)) << "ball " << i;
    }
    // With leaves of twelve points and about a hundred points inside, the rim costs about as much
    // as the inside.
    EXPECT_LT(looked_at, 4 * inside);
}

/// Clouds of special shapes, all with the same number of points.
struct Degenerate {
    const char* name;
    Points points_m;
};

std::vector<Degenerate> degenerate_clouds(std::size_t count) {
    Rng rng(11);
    std::vector<Degenerate> clouds;
    const auto make = [&](const char* name, const auto& point) {
        Points points_m;
        for (std::size_t i = 0; i < count; ++i) points_m.push_back(point(i));
        clouds.push_back({name, std::move(points_m)});
    };
    const auto c = [](std::size_t i) { return static_cast<float>(i); };
    const auto uniform = [&] { return static_cast<float>(rng.uniform()); };
    make("scattered", [&](std::size_t) { return random_point(rng, 1.0); });
    make("one place", [](std::size_t) { return Vector3f(1.0F, 2.0F, 3.0F); });
    make("one place and another",
         [&](std::size_t i) { return Vector3f(i % 2 == 0 ? 1.0F : 2.0F, 2.0F, 3.0F); });
    // Only the last bits of 1.0 differ: 27 positions.
    make("nearly one place", [&](std::size_t) -> Vector3f {
        return Vector3f::Ones() + 1e-7F * random_point(rng, 1.0);
    });
    // Squared distances are zero for different points.
    make("around zero", [&](std::size_t) -> Vector3f { return 1e-25F * random_point(rng, 1.0); });
    make("each point a hundred times",
         [&](std::size_t i) { return Vector3f(c(i / 100 % 7), c(i / 700 % 5), c(i / 3500)); });
    make("half of them one place", [&](std::size_t i) {
        return i % 2 == 0 ? Vector3f(0.3F, 0.3F, 0.3F) : random_point(rng, 1.0);
    });
    make("a line along an axis", [&](std::size_t i) { return Vector3f(c(i), 0.0F, 0.0F); });
    make("a line across the axes",
         [&](std::size_t) -> Vector3f { return uniform() * Vector3f(1.0F, 2.0F, 3.0F); });
    make("a plane", [&](std::size_t) { return Vector3f(uniform(), uniform(), 0.5F); });
    make("a lattice in a plane",
         [&](std::size_t i) { return Vector3f(c(i % 100), c(i / 100), 0.0F); });
    make("a lattice in space",
         [&](std::size_t i) { return Vector3f(c(i % 25), c(i / 25 % 25), c(i / 625)); });
    return clouds;
}

TEST(KdTree, DegenerateCloudsCostNoMoreThanOthers) {
    constexpr std::size_t kCount = 20000;
    constexpr std::size_t kQueries = 500;
    // Seven neighbours of scattered points: measured 31 nodes and 72 points. A leaf has twelve
    // points.
    constexpr std::size_t kMostNodes = 120;
    constexpr std::size_t kMostPoints = 300;
    for (const Degenerate& cloud : degenerate_clouds(kCount)) {
        const KdTree tree(cloud.points_m);
        Rng rng(12);
        SearchWork nearest;
        SearchWork exact;
        for (std::size_t i = 0; i < kQueries; ++i) {
            const Vector3f& p_m = cloud.points_m[rng.below(kCount)];
            const SearchWork one = tree.work_of_nearest(p_m, 7);
            const SearchWork other = tree.work_of_find(p_m);
            nearest = {nearest.nodes + one.nodes, nearest.points + one.points};
            exact = {exact.nodes + other.nodes, exact.points + other.points};
            ASSERT_NE(tree.find(p_m), Neighbour::kNone) << cloud.name;
            ASSERT_EQ(tree.points_m()[tree.find(p_m)], p_m) << cloud.name;
        }
        EXPECT_LT(nearest.nodes, kMostNodes * kQueries) << cloud.name;
        EXPECT_LT(nearest.points, kMostPoints * kQueries) << cloud.name;
        EXPECT_LT(exact.nodes, kMostNodes * kQueries) << cloud.name;
        EXPECT_LT(exact.points, kMostPoints * kQueries) << cloud.name;
    }
}

TEST(KdTree, SurfacesSeenFromFarAwayAreNotSearchedFromEndToEnd) {
    // From 5 km away all points of a square metre have the same distance to the last bit of a
    // float.
    Rng rng(13);
    Points points_m;
    for (int i = 0; i < 20000; ++i) {
        points_m.push_back(random_point(rng, 0.5));
        points_m.back().z() = 0.0F;
    }
    const KdTree tree(points_m);
    SearchWork all;
    constexpr int kQueries = 100;
    for (int i = 0; i < kQueries; ++i) {
        const SearchWork one =
            tree.work_of_nearest(Vector3f(0.0F, 0.0F, 5000.0F) + random_point(rng, 0.5), 1);
        all = {all.nodes + one.nodes, all.points + one.points};
    }
    EXPECT_LT(all.points, 300U * kQueries);
}

TEST(KdTree, CopiesAreOneRunThatCountsForAll) {
    Points points_m(5000, Vector3f(1.0F, 0.0F, 0.0F));
    points_m.resize(8000, Vector3f(1.0F, 0.5F, 0.0F));
    const KdTree tree(points_m);
    std::size_t visited = 0;
    std::size_t near = 0;
    const auto visit = [&](std::span<const Vector3f> run, std::size_t copies) {
        visited += run.size();
        for (const Vector3f& p_m : run) near += p_m.y() == 0.0F ? copies : 0;
    };
    tree.runs_near_ball({1.0F, 0.0F, 0.0F}, 0.1F, visit);
    EXPECT_EQ(near, 5000U);
    EXPECT_LT(visited, 100U);
    near = 0;
    tree.runs_near_cylinder({{1.0F, 0.0F, 0.0F}, Vector3f::UnitZ(), 0.1F, 0.1F}, visit);
    EXPECT_EQ(near, 5000U);
    EXPECT_LT(visited, 200U);
    std::vector<Neighbour> found(7000);
    EXPECT_EQ(tree.nearest({1.0F, 0.0F, 0.0F}, found), 7000U);
    EXPECT_EQ(found[4999].sq_distance_m2, 0.0F);
    EXPECT_EQ(found[5000].sq_distance_m2, 0.25F);
}

TEST(KdTree, AQueryBeyondAllSquaresFindsNothing) {
    const KdTree tree(scan(100, 14));
    EXPECT_EQ(tree.nearest({1e30F, 0.0F, 0.0F}).index, Neighbour::kNone);
    std::vector<Neighbour> found(3);
    EXPECT_EQ(tree.nearest({1e30F, 0.0F, 0.0F}, found), 0U);
    EXPECT_EQ(tree.nearest({KdTree::kFarthest_m, 0.0F, 0.0F}, found), 3U);
}

TEST(SpatialOrder, NamesEveryPointOnceAndKeepsNeighboursTogether) {
    EXPECT_TRUE(spatial_order({}).empty());
    EXPECT_EQ(spatial_order(Points(3, Vector3f(1.0F, 1.0F, 1.0F))),
              (std::vector<std::uint32_t>{0, 1, 2}));
    const Points points_m = scan(20000, 9);
    std::vector<std::uint32_t> order = spatial_order(points_m);
    double way_m = 0.0;
    double unsorted_m = 0.0;
    for (std::size_t i = 1; i < order.size(); ++i) {
        way_m += static_cast<double>((points_m[order[i]] - points_m[order[i - 1]]).norm());
        unsorted_m += static_cast<double>((points_m[i] - points_m[i - 1]).norm());
    }
    EXPECT_LT(way_m, 0.05 * unsorted_m);
    std::sort(order.begin(), order.end());
    std::vector<std::uint32_t> all(points_m.size());
    std::iota(all.begin(), all.end(), 0U);
    EXPECT_EQ(order, all);
}

TEST(SurfaceNormal, IsAcrossAPlaneAndPointsUp) {
    Rng rng(4);
    for (int i = 0; i < 50; ++i) {
        const Vector3f normal = random_point(rng, 1.0).normalized();
        const Vector3f side = normal.unitOrthogonal();
        Points points_m;
        for (int k = 0; k < 60; ++k) {
            points_m.push_back(static_cast<float>(rng.uniform(-0.1, 0.1)) * side +
                               static_cast<float>(rng.uniform(-0.1, 0.1)) * normal.cross(side) +
                               Vector3f(5.0F, -3.0F, 1.0F));
        }
        const KdTree tree(points_m);
        const auto found = surface_normal(tree, {5.0F, -3.0F, 1.0F}, 0.05F);
        ASSERT_TRUE(found.has_value());
        // Coordinates of 5 m are rounded to half a micrometre, over 50 mm.
        EXPECT_NEAR(std::abs(found->dot(normal)), 1.0F, 1e-6F);
        EXPECT_GT(found->z(), 0.0F);
    }
}

TEST(SurfaceNormal, NoneForTooFewPointsALineOrOnePlace) {
    Points line;
    for (int i = 0; i < 9; ++i) line.emplace_back(0.01F * static_cast<float>(i), 0.0F, 0.0F);
    EXPECT_FALSE(surface_normal(KdTree(line), Vector3f::Zero(), 1.0F));
    EXPECT_FALSE(surface_normal(KdTree(Points(9, Vector3f::Ones())), Vector3f::Ones(), 1.0F));
    EXPECT_FALSE(surface_normal(
        KdTree(Points{{0.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}}), Vector3f::Zero(), 2.0F));
    // A wall has no upper side: its normal points along the larger of x and y.
    Points wall;
    for (int i = 0; i < 100; ++i)
        wall.emplace_back(
            1.0F, 0.01F * static_cast<float>(i % 10), 0.01F * static_cast<float>(i / 10));
    const auto normal = surface_normal(KdTree(wall), {1.0F, 0.05F, 0.05F}, 0.04F);
    ASSERT_TRUE(normal.has_value());
    EXPECT_NEAR(normal->x(), 1.0F, 1e-6F);
}

}  // namespace
}  // namespace surefoot::geometry
