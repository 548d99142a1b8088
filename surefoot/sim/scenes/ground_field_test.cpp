// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/ground_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "surefoot/sim/safety_oracle/safety_testing.hpp"

namespace surefoot::sim {
namespace {

using namespace testing;
using Eigen::Vector2d;

constexpr double kReach_m = 0.144;

/// Floor with a pit, a kerb, a ramp, a table with a leg, a beam.
World furnished() {
    World world(PlanarPose::of(0.1, -0.2, 0.4));
    world.floor(0.0, {Pit{{{0.2, -0.6}, {0.5, -0.3}}, 0.3}})
        .box({0.6, 1.2}, {-0.2, 0.5}, {0.0, 0.075})
        .slab({-0.8, -0.1}, {-0.5, 0.1}, -1.0, {0.1, 0.05}, 0.09)
        .box({0.1, 0.7}, {0.3, 0.9}, {0.69, 0.72})
        .box({0.15, 0.2}, {0.35, 0.4}, {0.0, 0.69})
        .box({-1.0, 1.0}, {-0.9, -0.7}, {1.9, 2.2});
    return world;
}

TEST(GroundFieldTest, EverySampleEqualsTheSurfacesOfTheScene) {
    const World world = furnished();
    const PlanarPose T = PlanarPose::of(0.05, 0.1, -0.7);
    const LevelPlane level{0.01, {0.05, -0.02}};
    const GroundField field(world.scene, T, {{-0.7, -0.6}, {0.8, 0.7}}, level, kReach_m);
    int grounds_above = 0;
    for (int j = field.range().min_j; j <= field.range().max_j; j += 3) {
        for (int i = field.range().min_i; i <= field.range().max_i; i += 3) {
            const Vector2d p = GroundField::point_m(i, j);
            const Vector2d w = T * p;
            const double highest_m = level.at(p) + kReach_m;
            const auto surfaces = world.scene.surfaces_at(w.x(), w.y());  // highest first
            ASSERT_FALSE(surfaces.empty());
            double expected_m = surfaces.back().z_m;
            for (const SurfaceHeight& surface : surfaces) {
                if (surface.z_m > highest_m) continue;
                expected_m = surface.z_m;
                break;
            }
            grounds_above += expected_m > highest_m ? 1 : 0;
            const GroundSample& sample = field.at(i, j);
            EXPECT_EQ(sample.ground_m, expected_m) << p.transpose();
            const bool high = surfaces.front().z_m > highest_m;
            EXPECT_EQ(std::isfinite(sample.underside_m), high) << p.transpose();
            if (high) {
                EXPECT_EQ(sample.top_m, surfaces.front().z_m);
            }
            const auto plumb = sample_ground(world.scene, w.x(), w.y(), level.at(p), kReach_m);
            EXPECT_EQ(plumb.ground_m, sample.ground_m);
            EXPECT_EQ(plumb.underside_m, sample.underside_m);
        }
    }
    EXPECT_GT(grounds_above, 3);  // the leg of the table carries its top
}

TEST(GroundFieldTest, TheUndersideIsWhatARayFromTheFloorMeets) {
    const World world = furnished();
    const GroundField field(world.scene, {}, {{-0.6, -0.6}, {0.8, 0.8}}, {}, kReach_m);
    int met = 0;
    for (int j = field.range().min_j; j <= field.range().max_j; j += 5) {
        for (int i = field.range().min_i; i <= field.range().max_i; i += 5) {
            const Vector2d p = GroundField::point_m(i, j);
            const GroundSample& sample = field.at(i, j);
            if (sample.ground_m > kReach_m) continue;  // inside a solid: nothing is met
            const Eigen::Vector3d from(p.x(), p.y(), sample.ground_m + 1e-6);
            const auto hit = world.scene.intersect(from, Eigen::Vector3d::UnitZ());
            ASSERT_EQ(hit.has_value(), std::isfinite(sample.underside_m)) << p.transpose();
            if (!hit) continue;
            EXPECT_NEAR(hit->point_m.z(), sample.underside_m, 1e-9) << p.transpose();
            ++met;
        }
    }
    EXPECT_GT(met, 100);
}

TEST(GroundFieldTest, TilesBoundTheirSamplesAndCoverAll) {
    const World world = furnished();
    const GroundField field(world.scene, {}, {{-0.6, -0.6}, {0.8, 0.8}}, {}, kReach_m);
    long covered = 0;
    for (const GroundField::Tile& tile : field.tiles()) {
        for (int j = tile.range.min_j; j <= tile.range.max_j; ++j) {
            for (int i = tile.range.min_i; i <= tile.range.max_i; ++i) {
                const GroundSample& sample = field.at(i, j);
                ASSERT_GE(sample.ground_m, tile.lowest_ground_m);
                ASSERT_LE(sample.ground_m, tile.highest_ground_m);
                ASSERT_GE(sample.underside_m, tile.lowest_underside_m);
                ASSERT_LE(sample.top_m, tile.highest_top_m);
                ++covered;
            }
        }
    }
    const auto& r = field.range();
    EXPECT_EQ(covered, long{r.max_i - r.min_i + 1} * long{r.max_j - r.min_j + 1});
}

TEST(GroundFieldTest, GroundIsReachedRoundATrenchButNotAcross) {
    const Pit across{{{0.2, -2.0}, {0.3, 2.0}}, 0.3};
    const Pit open{{{0.2, -2.0}, {0.3, 0.1}}, 0.3};
    const Rect region{{-0.2, -0.4}, {0.6, 0.4}};
    for (const auto& [pit, expected] : {std::pair{across, false}, {open, true}}) {
        const World world = World().floor(0.0, {pit});
        const GroundField field(world.scene, {}, region, {}, kReach_m);
        const auto reached = field.reached_from({{0, 2, 0, 2}}, 0.04);
        EXPECT_TRUE(reached[field.index(-20, 30)] != 0);
        EXPECT_EQ(reached[field.index(100, -30)] != 0, expected);
        EXPECT_FALSE(reached[field.index(50, -30)] != 0);
    }
}

TEST(GroundFieldTest, ASceneWithoutAnythingHasNoGround) {
    const GroundField field(Scene(), {}, {{0.0, 0.0}, {0.1, 0.1}}, {}, kReach_m);
    EXPECT_TRUE(std::isnan(field.at(0, 0).ground_m));
    EXPECT_EQ(field.range_of({{1.0, 1.0}, {2.0, 2.0}}).max_i, field.range().max_i);
    EXPECT_FALSE(std::isfinite(field.tiles().front().lowest_ground_m));
}

}  // namespace
}  // namespace surefoot::sim
