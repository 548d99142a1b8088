// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/clouds/cloud_measures.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/core/rng.hpp"

namespace surefoot::eval {
namespace {

using Points = std::vector<Eigen::Vector3f>;

constexpr double kRiser_m = 0.17;
constexpr double kGoing_m = 0.285;
constexpr double kWidth_m = 1.25;
constexpr int kSteps = 8;

/// A flight along `yaw_rad` behind a floor, with a wall on its right; `faces`: risers have points.
Points flight(double yaw_rad, bool faces, double noise_m, std::uint64_t seed) {
    Rng rng(seed);
    Points points_m;
    const Eigen::Vector2d way(std::cos(yaw_rad), std::sin(yaw_rad));
    const Eigen::Vector2d left(-way.y(), way.x());
    for (int i = 0; i < 60000; ++i) {
        double s_m = 0.0;
        double y_m = rng.uniform(0.0, kWidth_m);
        double z_m = 0.0;
        const std::uint64_t kind = rng.below(10);
        const auto step = static_cast<double>(rng.below(kSteps));
        if (kind < 2) {
            s_m = rng.uniform(-2.0, 0.0);
        } else if (kind < 3) {  // the wall
            s_m = rng.uniform(-2.0, kGoing_m * kSteps);
            z_m = rng.uniform(0.0, 2.5);
            y_m = 0.0;
        } else if (kind < 6 && faces) {
            s_m = kGoing_m * step;
            z_m = kRiser_m * (step + rng.uniform());
        } else {
            s_m = kGoing_m * (step + rng.uniform());
            z_m = kRiser_m * (step + 1.0);
        }
        const Eigen::Vector2d xy_m = s_m * way + y_m * left + Eigen::Vector2d(3.0, -1.0);
        points_m.emplace_back(static_cast<float>(xy_m.x() + noise_m * rng.normal()),
                              static_cast<float>(xy_m.y() + noise_m * rng.normal()),
                              static_cast<float>(z_m + noise_m * rng.normal()));
    }
    return points_m;
}

StairMeasures measured(const Points& points_m) {
    const SortedSurfaces surfaces = sort_surfaces(points_m);
    return measure_stairs(surfaces, height_histogram(surfaces.level_m).levels);
}

TEST(HeightHistogram, CountsEveryPointAndFindsTheLevels) {
    const Points points_m = flight(0.4, true, 0.002, 1);
    const SortedSurfaces surfaces = sort_surfaces(points_m);
    const HeightHistogram h = height_histogram(surfaces.level_m);
    std::int64_t sum = 0;
    for (const std::int64_t count : h.counts) sum += count;
    EXPECT_EQ(sum, static_cast<std::int64_t>(surfaces.level_m.size()));
    EXPECT_GT(surfaces.upright_m.size(), 5000U);
    ASSERT_EQ(h.levels.size(), kSteps + 1U);
    for (std::size_t i = 0; i < h.levels.size(); ++i) {
        // Some 2000 points of 2 mm: 0.05 mm.
        EXPECT_NEAR(h.levels[i].height_m, kRiser_m * static_cast<double>(i), 2e-4) << i;
        EXPECT_LT(h.levels[i].rms_m, 0.0025);
        EXPECT_LT(h.levels[i].tilt_rad, 0.01);
    }
}

TEST(HeightHistogram, NothingEvenAndOnePlace) {
    EXPECT_TRUE(height_histogram({}).levels.empty());
    EXPECT_TRUE(height_histogram(Points(1000, {1, 2, 3})).levels.empty()) << "has no plane";
    EXPECT_TRUE(height_histogram(Points{{0, 0, 0}, {0, 0, 1e6F}}).counts.empty());
    Rng rng(2);
    Points wall_m;
    for (int i = 0; i < 20000; ++i) {
        wall_m.emplace_back(
            static_cast<float>(rng.uniform()), 0.0F, static_cast<float>(2.0 * rng.uniform()));
    }
    EXPECT_TRUE(height_histogram(wall_m).levels.empty());
}

TEST(StairMeasures, RiserAndGoingOfAFlightInAnyDirection) {
    for (const double yaw_rad : {0.0, 0.4, -2.0}) {
        const Points points_m = flight(yaw_rad, true, 0.002, 3);
        const StairMeasures m = measured(points_m);
        ASSERT_EQ(m.riser.values_m.size(), static_cast<std::size_t>(kSteps));
        EXPECT_NEAR(m.riser.mean_m, kRiser_m, 2e-4);
        EXPECT_LT(m.riser.spread_m, 5e-4);
        ASSERT_EQ(m.going.values_m.size(), kSteps - 1U);
        EXPECT_NEAR(m.going.mean_m, kGoing_m, 2e-3);
        EXPECT_LT(m.going.spread_m, 4e-3);
        EXPECT_NEAR(std::atan2(m.uphill.y(), m.uphill.x()), yaw_rad, 0.05);
    }
}

TEST(StairMeasures, ALandingIsNoGoing) {
    constexpr double kLanding_m = 0.9;
    Points points_m = flight(0.0, true, 0.002, 5);
    const auto middle_m = static_cast<float>(3.0 + 4.0 * kGoing_m - 0.01);
    for (Eigen::Vector3f& p_m : points_m)
        if (p_m.x() > middle_m) p_m.x() += static_cast<float>(kLanding_m);
    Rng rng(6);
    for (int i = 0; i < 9000; ++i) {
        points_m.emplace_back(middle_m + static_cast<float>(rng.uniform(0.0, kLanding_m)),
                              static_cast<float>(rng.uniform(-1.0, kWidth_m - 1.0)),
                              static_cast<float>(4.0 * kRiser_m + 0.002 * rng.normal()));
    }
    const StairMeasures m = measured(points_m);
    ASSERT_EQ(m.riser.values_m.size(), static_cast<std::size_t>(kSteps));
    ASSERT_EQ(m.going.values_m.size(), kSteps - 2U);
    EXPECT_NEAR(m.going.mean_m, kGoing_m, 3e-3);
}

TEST(StairMeasures, LevelsBetweenTheTreadsAndBesideThemAreNoSteps) {
    // A depth camera's noise, patches of points in flight half way up, a shelf beside the flight.
    Points points_m = flight(0.4, true, 0.005, 7);
    Rng rng(8);
    const auto patch = [&](double s_m, double y_m, double z_m, int count, double side_m) {
        const Eigen::Vector2d way(std::cos(0.4), std::sin(0.4));
        const Eigen::Vector2d left(-way.y(), way.x());
        for (int i = 0; i < count; ++i) {
            const Eigen::Vector2d xy_m = (s_m + rng.uniform(0.0, side_m)) * way +
                                         (y_m + rng.uniform(0.0, side_m)) * left +
                                         Eigen::Vector2d(3.0, -1.0);
            points_m.emplace_back(static_cast<float>(xy_m.x()),
                                  static_cast<float>(xy_m.y()),
                                  static_cast<float>(z_m + 0.003 * rng.normal()));
        }
    };
    for (int step = 1; step < kSteps; ++step)
        patch(kGoing_m * step, 1.5, kRiser_m * (step + 0.5), 700, 0.22);
    patch(0.3, -0.8, 0.43, 3000, 0.5);
    patch(1.1, -0.8, 0.61, 3000, 0.5);
    const SortedSurfaces surfaces = sort_surfaces(points_m);
    const HeightHistogram heights = height_histogram(surfaces.level_m);
    EXPECT_GT(heights.levels.size(), kSteps + 3U);
    const StairMeasures m = measure_stairs(surfaces, heights.levels);
    EXPECT_EQ(m.riser.values_m.size(), static_cast<std::size_t>(kSteps));
    EXPECT_NEAR(m.riser.mean_m, kRiser_m, 0.001);
    EXPECT_LT(m.riser.spread_m, 0.003);
    EXPECT_NEAR(m.going.mean_m, kGoing_m, 0.01);
}

TEST(StairMeasures, GoingsOfAMapWithoutFaces) {
    const Points points_m = flight(0.0, false, 0.004, 4);
    const StairMeasures m = measured(points_m);
    ASSERT_EQ(m.riser.values_m.size(), static_cast<std::size_t>(kSteps));
    EXPECT_NEAR(m.riser.mean_m, kRiser_m, 5e-4);
    ASSERT_GE(m.going.values_m.size(), kSteps - 2U);
    EXPECT_NEAR(m.going.mean_m, kGoing_m, 5e-3);
}

TEST(StairMeasures, LevelsOneBesideTheOtherHaveNoGoing) {
    // Equal rises, but the third level begins far behind the second.
    constexpr double kBegin_m[] = {0.0, 1.0, -2.0};
    constexpr double kLength_m[] = {1.5, 1.5, 6.5};
    Points points_m;
    Rng rng(9);
    for (int level = 0; level < 3; ++level) {
        for (int i = 0; i < 20000; ++i) {
            points_m.emplace_back(
                static_cast<float>(kBegin_m[level] + rng.uniform(0.0, kLength_m[level])),
                static_cast<float>(rng.uniform(0.0, 1.0)),
                static_cast<float>(kRiser_m * level + 0.002 * rng.normal()));
        }
    }
    for (const double going_m : measured(points_m).going.values_m) EXPECT_GE(going_m, 0.1);
}

TEST(StairMeasures, NoStairsNoMeasures) {
    EXPECT_TRUE(std::isnan(measure_stairs({}, {}).riser.mean_m));
    Level floor;
    Level table;
    table.height_m = 0.75;
    table.middle_m = {1.0, 0.0};
    const StairMeasures m = measure_stairs({}, std::vector<Level>{floor, table});
    EXPECT_TRUE(m.riser.values_m.empty());
    EXPECT_TRUE(m.going.values_m.empty());
}

TEST(DoorWidth, IsBetweenTheJambs) {
    Rng rng(5);
    Points points_m;
    constexpr double kDoor_m = 0.9;
    const auto noise_m = [&] { return 0.002 * rng.normal(); };
    for (int i = 0; i < 40000; ++i) {  // a wall of 0.12 m with an opening, x is the way through
        double y_m = rng.uniform(-2.5, 2.5);
        double x_m = rng.below(2) == 0 ? 0.06 : -0.06;
        if (std::abs(y_m) < kDoor_m / 2.0) {
            y_m = std::copysign(kDoor_m / 2.0, y_m);  // the jambs
            x_m = rng.uniform(-0.06, 0.06);
        }
        points_m.emplace_back(static_cast<float>(x_m + noise_m()),
                              static_cast<float>(y_m + noise_m()),
                              static_cast<float>(rng.uniform(0.0, 2.0)));
    }
    const auto width_m = door_width_m(points_m, {{0.0, 0.1}, 0.0, 0.0});
    ASSERT_TRUE(width_m.has_value());
    EXPECT_NEAR(*width_m, kDoor_m, 1e-3);
    EXPECT_FALSE(door_width_m(points_m, {{0.0, 9.0}, 0.0, 0.0}));
    EXPECT_FALSE(door_width_m(points_m, {{0.0, 0.0}, 0.0, 5.0})) << "nothing stands so high";
}

}  // namespace
}  // namespace surefoot::eval
