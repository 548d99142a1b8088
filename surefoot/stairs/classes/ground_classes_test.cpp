// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/classes/ground_classes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "surefoot/core/unknown.hpp"
#include "surefoot/stairs/feature_finder.hpp"
#include "surefoot/stairs/terrain_testing.hpp"

namespace surefoot::stairs {
namespace {

using testing::TestFlight;
using testing::TestMap;
using enum GroundClass;

const char* name_of(GroundClass name) {
    return kGroundClassNames[static_cast<std::size_t>(name)];
}

/// A map with free-space evidence, and the classes computed from it.
class Named {
  public:
    explicit Named(TestMap map, const Eigen::Vector2d& stance_m = {-1.0, 0.0})
        : map_(std::move(map)),
          stance_m_(stance_m),
          free_above_m(map_.geometry.nx, map_.geometry.ny, kNanF),
          clearance_m(map_.geometry.nx, map_.geometry.ny, kNanF) {}

    void classify(const StairsConfig& config = {}) {
        Terrain terrain = map_.terrain(stance_m_);
        terrain.free_above_m = free_above_m.view();
        terrain.clearance_m = clearance_m.view();
        FeatureFinder(config).find(terrain, features);
        classes = classify_ground(config, terrain, features);
    }
    /// Calls f(cell) for all cells whose centre lies in a rectangle of the world.
    template <typename F>
    void for_cells(Eigen::Vector2d low_m, Eigen::Vector2d high_m, const F& f) const {
        for (int iy = 0; iy < map_.geometry.ny; ++iy) {
            for (int ix = 0; ix < map_.geometry.nx; ++ix) {
                const Eigen::Vector2d p_m = map_.to_world(map_.geometry.center_m({ix, iy}));
                if ((p_m.array() > low_m.array()).all() && (p_m.array() < high_m.array()).all())
                    f(grid::Cell{ix, iy});
            }
        }
    }
    /// Share of the cells in a rectangle of the world that have a given class.
    [[nodiscard]] double share(GroundClass name,
                               const Eigen::Vector2d& low_m,
                               const Eigen::Vector2d& high_m) const {
        int all = 0, named = 0;
        for_cells(low_m, high_m, [&](grid::Cell cell) {
            ++all;
            named += classes.of_cell.at(cell.ix, cell.iy) == name ? 1 : 0;
        });
        EXPECT_GT(all, 0);
        return named / static_cast<double>(all);
    }
    [[nodiscard]] int count(GroundClass name) const {
        return count_classes(classes)[static_cast<std::size_t>(name)];
    }
    TestMap& map() { return map_; }

    TerrainFeatures features;
    GroundClasses classes;

  private:
    TestMap map_;
    Eigen::Vector2d stance_m_;

  public:
    grid::Layer free_above_m;
    grid::Layer clearance_m;
};

TestMap noisy(const testing::Ground& ground, double sigma_m, double yaw_deg = 17.0) {
    TestMap map(ground, yaw_deg * kRadPerDeg, {0.008, 0.003});
    if (sigma_m > 0.0) map.add_noise(sigma_m, 21);
    return map;
}

TEST(GroundClasses, AllKnownLevelGroundIsFloorAndNothingElse) {
    for (const double sigma_m : {0.0, 0.005, 0.010}) {
        Named named(noisy([](double, double) { return 0.25; }, sigma_m));
        named.classify();
        const int cells = 200 * 200;
        // 0.27 % of normal noise lies beyond 3 sigma of the plane: these cells are unknown.
        EXPECT_GE(named.count(floor), 0.995 * cells) << sigma_m;
        EXPECT_EQ(named.count(floor) + named.count(unknown) + named.count(drop), cells) << sigma_m;
        EXPECT_LE(named.count(drop), 4) << sigma_m;
    }
}

TEST(GroundClasses, StepsAreTreadsAndRisersAndTheirLandingIsFloor) {
    const TestFlight flight{.steps = 5, .riser_m = 0.17, .going_m = 0.30, .width_m = 1.4};
    for (const double sigma_m : {0.0, 0.005}) {
        Named named(noisy([&](double x_m, double y_m) { return flight.at(x_m, y_m); }, sigma_m));
        named.classify();
        ASSERT_EQ(named.features.flights.size(), 1U);
        for (int k = 0; k < 4; ++k) {
            const double x_m = 0.30 * k;
            EXPECT_GE(named.share(tread, {x_m + 0.04, -0.6}, {x_m + 0.26, 0.6}), 0.99) << k;
            EXPECT_GE(named.share(riser, {x_m - 0.006, -0.6}, {x_m + 0.006, 0.6}), 0.9) << k;
        }
        EXPECT_GE(named.share(floor, {1.27, -0.6}, {2.0, 0.6}), 0.99) << "landing";
        EXPECT_GE(named.share(floor, {-2.0, -2.0}, {-0.05, 2.0}), 0.99);
        EXPECT_EQ(named.share(floor, {0.03, -0.6}, {1.17, 0.6}), 0.0) << "a tread is no floor";
    }
}

TEST(GroundClasses, TreadsAreLevelsOfTheirOwnAndHeightsStayAsMeasured) {
    const TestFlight flight{.steps = 5, .riser_m = 0.17, .going_m = 0.30, .width_m = 1.4};
    TestMap map = noisy([&](double x_m, double y_m) { return flight.at(x_m, y_m); }, 0.008);
    const grid::Layer measured = map.height_m;
    Named named(map);
    named.classify();
    for (std::size_t i = 0; i < measured.size(); ++i)
        ASSERT_EQ(named.map().height_m.data()[i], measured.data()[i]);
    for (int k = 0; k < 4; ++k) {
        std::optional<float> level_m;
        const double x_m = 0.30 * k;
        named.for_cells({x_m + 0.04, -0.5}, {x_m + 0.26, 0.5}, [&](grid::Cell cell) {
            const float height_m = named.classes.tread_height_m.at(cell.ix, cell.iy);
            const float sigma_m = named.classes.tread_sigma_m.at(cell.ix, cell.iy);
            if (named.classes.of_cell.at(cell.ix, cell.iy) != tread) {
                EXPECT_TRUE(std::isnan(height_m));
                return;
            }
            if (!level_m) level_m = height_m;
            EXPECT_EQ(height_m, *level_m) << "one height for all cells of a tread";
            EXPECT_GT(sigma_m, 0.0F);
            EXPECT_LT(sigma_m, 0.003F);
            EXPECT_NEAR(static_cast<double>(height_m), 0.17 * (k + 1), 3.0 * 0.001);
        });
        EXPECT_TRUE(level_m) << k;
    }
    named.for_cells({-2.0, -2.0}, {-0.1, 2.0}, [&](grid::Cell cell) {
        EXPECT_TRUE(std::isnan(named.classes.tread_height_m.at(cell.ix, cell.iy)));
    });
}

// A suitcase on a step and cells next to the riser must not move the tread.
TEST(GroundClasses, WhatStandsOnATreadDoesNotMoveIt) {
    const TestFlight flight{.steps = 4, .riser_m = 0.17, .going_m = 0.30, .width_m = 1.4};
    const auto ground = [&](double x_m, double y_m) {
        const bool thing = x_m > 0.35 && x_m < 0.55 && y_m > 0.2 && y_m < 0.6;
        return flight.at(x_m, y_m) + (thing ? 0.06 : 0.0);
    };
    Named named(noisy(ground, 0.004));
    named.classify();
    ASSERT_EQ(named.features.flights.size(), 1U);
    EXPECT_EQ(named.share(tread, {0.38, 0.23}, {0.52, 0.57}), 0.0);
    EXPECT_EQ(named.share(floor, {0.38, 0.23}, {0.52, 0.57}), 0.0);
    int cells = 0;
    named.for_cells({0.34, -0.5}, {0.56, 0.1}, [&](grid::Cell cell) {
        if (named.classes.of_cell.at(cell.ix, cell.iy) != tread) return;
        ++cells;
        EXPECT_NEAR(
            static_cast<double>(named.classes.tread_height_m.at(cell.ix, cell.iy)), 0.34, 0.002);
    });
    EXPECT_GT(cells, 150);
}

TEST(GroundClasses, ARampIsSteeperThanOneInTwenty) {
    for (const double sigma_m : {0.0, 0.005}) {
        const auto slope = [](double one_in) {
            return [one_in](double x_m, double) { return x_m < 0.0 ? 0.0 : x_m / one_in; };
        };
        Named ramp_12(noisy(slope(12.0), sigma_m));
        ramp_12.classify();
        EXPECT_GE(ramp_12.share(ramp, {0.3, -1.5}, {2.0, 1.5}), 0.99) << sigma_m;
        EXPECT_GE(ramp_12.share(floor, {-2.0, -1.5}, {-0.2, 1.5}), 0.99) << sigma_m;
        Named fall_50(noisy(slope(50.0), sigma_m));  // a cross fall of 1:50 is level (ADA 403.3)
        fall_50.classify();
        EXPECT_EQ(fall_50.count(ramp), 0) << sigma_m;
        EXPECT_GE(fall_50.share(floor, {-2.0, -1.5}, {2.0, 1.5}), 0.99) << sigma_m;
        Named steep(noisy(slope(2.0), sigma_m));  // 27 deg: nobody walks on it
        steep.classify();
        EXPECT_EQ(steep.share(floor, {0.3, -1.5}, {2.0, 1.5}), 0.0) << sigma_m;
        EXPECT_EQ(steep.share(ramp, {0.3, -1.5}, {2.0, 1.5}), 0.0) << sigma_m;
    }
}

/// A table, a wall, a pit, and a kerb with the ground behind it.
double room(double x_m, double y_m) {
    if (x_m > 0.3 && x_m < 1.1 && std::abs(y_m - 0.9) < 0.35) return 0.72;
    if (y_m > 1.8 && y_m < 1.9) return 1.6;
    if (x_m < -2.0 && y_m < -1.0) return 1.5;  // a wide wall: too high for a table
    if (x_m > 0.2 && x_m < 1.0 && y_m > -1.5 && y_m < -0.8) return -0.30;
    return x_m > 1.6 ? 0.12 : 0.0;
}

TEST(GroundClasses, TableWallDropAndKerbAreToldFromTheFloor) {
    for (const double sigma_m : {0.0, 0.005, 0.010}) {
        Named named(noisy(room, sigma_m));
        named.classify();
        const auto where = ::testing::Message() << sigma_m;
        EXPECT_GE(named.share(table, {0.35, 0.6}, {1.05, 1.2}), 0.98) << where;
        EXPECT_GE(named.share(wall, {-1.5, 1.82}, {1.2, 1.88}), 0.95) << where;
        EXPECT_GE(named.share(wall, {-2.3, -1.6}, {-2.05, -1.1}), 0.95) << where;
        EXPECT_GE(named.share(drop, {0.25, -1.45}, {0.95, -0.85}), 0.98) << where;
        EXPECT_GE(named.share(floor, {-1.9, -1.5}, {0.1, 1.5}), 0.99) << where;
        EXPECT_GE(named.share(kerb, {1.594, -0.7}, {1.606, 0.4}), 0.9) << where;
        EXPECT_GE(named.share(floor, {1.65, -1.5}, {2.2, 1.5}), 0.97)
            << where << ": one steps onto a kerb";
        for (const GroundClass name : {table, wall, drop})
            EXPECT_EQ(named.share(name, {-1.9, -0.7}, {0.1, 0.4}), 0.0) << name_of(name);
    }
}

// A matcher smears the rim of 0.72 m over 0.15 m: no two neighbouring cells differ much.
TEST(GroundClasses, ATableWithASmearedRimIsNotWalkedTo) {
    const auto ground = [](double x_m, double) {
        return 0.72 * std::clamp((x_m - 0.5) / 0.15, 0.0, 1.0);
    };
    Named named(noisy(ground, 0.003));
    named.classify();
    EXPECT_GE(named.share(table, {0.75, -1.5}, {1.8, 1.5}), 0.98);
    EXPECT_EQ(named.share(floor, {0.52, -1.5}, {1.8, 1.5}), 0.0);
}

TEST(GroundClasses, NoWayLeadsUpASteepPlane) {
    const auto ground = [](double x_m, double) { return std::clamp(x_m - 0.3, 0.0, 0.7); };
    Named named(noisy(ground, 0.003));
    named.classify();
    EXPECT_GE(named.share(table, {1.1, -1.4}, {1.9, 1.4}), 0.98);
    EXPECT_EQ(named.share(floor, {0.4, -1.4}, {1.9, 1.4}), 0.0);
}

TEST(GroundClasses, UnknownStaysUnknownUnlessLinesOfSightPassBelowTheGround) {
    TestMap map = noisy([](double, double) { return 0.0; }, 0.003);
    Named named(map);
    const Eigen::Vector2d low_m(0.5, -0.8), high_m(1.0, 0.8);
    const auto hide = [&](float free_above_m) {
        named.for_cells(low_m, high_m, [&](grid::Cell cell) {
            named.map().height_m.at(cell.ix, cell.iy) = kNanF;
            named.free_above_m.at(cell.ix, cell.iy) = free_above_m;
        });
        named.classify();
    };
    hide(kNanF);
    EXPECT_EQ(named.share(unknown, low_m, high_m), 1.0);
    hide(0.4F);  // rays pass 0.4 m above the floor
    EXPECT_EQ(named.share(unknown, low_m, high_m), 1.0);
    hide(-0.03F);  // rays pass 30 mm below the floor: less than stairs.drop_m
    EXPECT_EQ(named.share(unknown, low_m, high_m), 1.0);
    hide(-0.25F);
    EXPECT_EQ(named.share(drop, low_m, high_m), 1.0);
}

TEST(GroundClasses, AHoleInATreadIsADropAndAHiddenPartIsUnknown) {
    const TestFlight flight{.steps = 4, .riser_m = 0.17, .going_m = 0.30, .width_m = 1.4};
    Named named(noisy([&](double x_m, double y_m) { return flight.at(x_m, y_m); }, 0.003));
    named.for_cells({0.36, -0.4}, {0.54, 0.0}, [&](grid::Cell cell) {
        named.map().height_m.at(cell.ix, cell.iy) = kNanF;
        named.free_above_m.at(cell.ix, cell.iy) = 0.1F;
    });
    named.for_cells({0.66, -0.4}, {0.84, 0.0}, [&](grid::Cell cell) {
        named.map().height_m.at(cell.ix, cell.iy) = kNanF;
        named.free_above_m.at(cell.ix, cell.iy) = 0.6F;
    });
    named.classify();
    ASSERT_EQ(named.features.flights.size(), 1U);
    EXPECT_EQ(named.share(drop, {0.37, -0.39}, {0.53, -0.01}), 1.0);
    EXPECT_EQ(named.share(unknown, {0.67, -0.39}, {0.83, -0.01}), 1.0);
    named.for_cells({0.36, -0.4}, {0.54, 0.0}, [&](grid::Cell cell) {
        EXPECT_TRUE(std::isnan(named.classes.tread_height_m.at(cell.ix, cell.iy)));
    });
}

TEST(GroundClasses, LowThingsOverheadMakeATunnelOfGroundOnly) {
    Named named(noisy(room, 0.003));
    named.for_cells({-2.0, -2.0}, {2.0, 2.0}, [&](grid::Cell cell) {
        const double y_m = named.map().to_world(named.map().geometry.center_m(cell)).y();
        named.clearance_m.at(cell.ix, cell.iy) = y_m < -0.2 ? 2.0F : 2.2F;
    });
    named.classify();
    EXPECT_GE(named.share(tunnel, {-1.9, -1.9}, {0.1, -0.25}), 0.99) << "2.05 m and 50 mm";
    EXPECT_EQ(named.share(tunnel, {-1.9, -0.15}, {1.9, 1.9}), 0.0);
    EXPECT_GE(named.share(drop, {0.25, -1.45}, {0.95, -0.85}), 0.98) << "a drop is worse";
}

TEST(GroundClasses, ACellThatIsKnownBadlyIsNoFloor) {
    Named named(noisy([](double, double) { return 0.0; }, 0.003));
    named.for_cells({0.0, 0.0}, {0.5, 0.5}, [&](grid::Cell cell) {
        named.map().var_m2.at(cell.ix, cell.iy) = 0.05F * 0.05F;
    });
    named.classify();
    EXPECT_EQ(named.share(unknown, {0.01, 0.01}, {0.49, 0.49}), 1.0);
    EXPECT_GE(named.share(floor, {-2.0, -2.0}, {-0.05, 2.0}), 0.99);
}

TEST(GroundClasses, ADropWhoseBottomIsNotSeenIsShownBehindItsBorder) {
    TestMap map = noisy([](double, double) { return 0.0; }, 0.002, 0.0);
    Named named(map);
    named.for_cells({0.5, -3.0}, {3.0, 3.0}, [&](grid::Cell cell) {
        named.map().height_m.at(cell.ix, cell.iy) = kNanF;
    });
    named.classify();
    EXPECT_EQ(named.count(drop), 0) << "nothing is said of what is not in view";
    LineFeature line;
    line.pose.p_m << named.map().to_map({0.5, 0.0}), 0.0;
    line.pose.yaw_rad = 0.0;
    line.height_m = -0.23;
    line.length_m = 2.0;
    line.bottom_seen = false;
    named.features.drops = {line};
    named.classes = classify_ground({}, named.map().terrain(), named.features);
    EXPECT_EQ(named.share(drop, {0.52, -0.95}, {0.63, 0.95}), 1.0);
    EXPECT_EQ(named.share(drop, {-1.0, -2.0}, {0.48, 2.0}), 0.0);
}

// Steps down, seen from their upper end.
TEST(GroundClasses, TreadsOfAFlightDownAreTreads) {
    const TestFlight flight{.steps = 4, .riser_m = -0.18, .going_m = 0.29, .width_m = 1.2};
    Named named(noisy([&](double x_m, double y_m) { return flight.at(x_m, y_m); }, 0.004));
    named.classify();
    ASSERT_EQ(named.features.flights.size(), 1U);
    for (int k = 0; k < 3; ++k)
        EXPECT_GE(named.share(tread, {0.29 * k + 0.04, -0.5}, {0.29 * k + 0.25, 0.5}), 0.98) << k;
    EXPECT_GE(named.share(floor, {0.95, -0.5}, {1.8, 0.5}), 0.98) << "the ground at its foot";
    // The ground beside the steps is up to 0.72 m higher than the steps, but it is no table.
    EXPECT_EQ(named.count(table), 0);
}

TEST(GroundClasses, WithoutGroundNearTheStanceTheNearestIsStoodOn) {
    Named named(noisy(room, 0.003), {-9.0, 0.0});
    named.classify();
    EXPECT_GE(named.share(floor, {-1.9, -1.5}, {0.1, 1.5}), 0.99);
    EXPECT_GE(named.share(table, {0.35, 0.6}, {1.05, 1.2}), 0.98);
}

TEST(GroundClasses, NothingKnownIsNothingNamed) {
    Named unknown_map(noisy([](double, double) { return 0.0; }, 0.0));
    unknown_map.map().height_m.fill(kNanF);
    unknown_map.classify();
    EXPECT_EQ(unknown_map.count(unknown), 200 * 200);
    Named noise(noisy([](double, double) { return 0.0; }, 0.3));
    noise.classify();
    EXPECT_EQ(noise.count(floor), 0) << "pure noise is no floor";
    EXPECT_EQ(noise.count(ramp) + noise.count(tread), 0);
    const TestMap none([](double, double) { return 0.0; }, 0.0, {0.0, 0.0}, 0.025, 0.025);
    const GroundClasses one = classify_ground({}, none.terrain(), {});
    EXPECT_EQ(one.of_cell.size(), 1U);
    EXPECT_EQ(one.of_cell.at(0, 0), unknown) << "one cell is no patch";
}

}  // namespace
}  // namespace surefoot::stairs
