// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/doors/bottlenecks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "surefoot/core/unknown.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr double kCell_m = 0.025;
constexpr int kSide = 120;
constexpr double kBlock_m = BottleneckFinder::kBlock_m;

/// Floor of 3 x 3 m that begins at the origin.
struct Floor {
    Image<float> height_m{kSide, kSide, 0.0F};

    Floor& wall(double x0_m, double y0_m, double x1_m, double y1_m, float top_m = 2.0F) {
        for (int iy = 0; iy < kSide; ++iy) {
            for (int ix = 0; ix < kSide; ++ix) {
                const Vector2d p_m = Vector2d(ix + 0.5, iy + 0.5) * kCell_m;
                if (p_m.x() > x0_m && p_m.x() < x1_m && p_m.y() > y0_m && p_m.y() < y1_m)
                    height_m.at(ix, iy) = top_m;
            }
        }
        return *this;
    }
};

std::vector<Bottleneck> bottlenecks(const Floor& floor) {
    Terrain terrain;
    terrain.geometry = {kCell_m, kSide, kSide, Vector2d::Zero()};
    terrain.height_m = floor.height_m.view();
    return BottleneckFinder().find(terrain, {0.6, 1.4, 0.5, 0.2});
}

TEST(Bottlenecks, BetweenTwoWallsInOneLine) {
    const auto found = bottlenecks(Floor().wall(1.5, 0.0, 1.6, 1.0).wall(1.5, 1.9, 1.6, 3.0));
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found[0].middle_m.x(), 1.55, kBlock_m);
    EXPECT_NEAR(found[0].middle_m.y(), 1.45, kBlock_m);
    EXPECT_GT(std::abs(found[0].across.y()), 0.99);
    EXPECT_NEAR(found[0].width_m, 0.9, 2.0 * kBlock_m);
}

TEST(Bottlenecks, NoneInACorridor) {
    EXPECT_TRUE(bottlenecks(Floor().wall(0.3, 0.8, 2.7, 1.0).wall(0.3, 1.9, 2.7, 2.1)).empty());
}

/// Two steps of a stair are as high as a wall, but not within kReach_m.
TEST(Bottlenecks, StepsAreNoWalls) {
    Floor floor;
    for (int step = 1; step < 4; ++step) {
        const float top_m = 0.18F * static_cast<float>(step);
        floor.wall(0.0, 0.0, 3.0, 1.43 - 0.28 * step, top_m);
        floor.wall(0.0, 1.57 + 0.28 * step, 3.0, 3.0, top_m);
    }
    floor.wall(0.0, 0.0, 1.3, 3.0, kNanF).wall(1.6, 0.0, 3.0, 3.0, kNanF);
    EXPECT_TRUE(bottlenecks(floor).empty());
}

/// A matcher rounds off the corner between floor and wall, so the ground there is not level.
TEST(Bottlenecks, WallsRiseFromTheLevelGroundNearby) {
    Floor floor;
    for (const double edge_m : {1.0, 1.9}) {
        for (int ix = 56; ix < 68; ++ix)
            for (int iy = static_cast<int>(edge_m / kCell_m) - 8; iy < edge_m / kCell_m + 8; ++iy)
                floor.height_m.at(ix, iy) = (ix + iy) % 2 == 0 ? 0.0F : 0.12F;
    }
    const auto found = bottlenecks(floor.wall(1.5, 0.0, 1.6, 1.0).wall(1.5, 1.9, 1.6, 3.0));
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found[0].width_m, 0.9, 2.0 * kBlock_m);
}

/// Scattered heights, such as a stereo camera measures on a wall.
TEST(Bottlenecks, WallsHaveNoLevelBlocks) {
    Floor floor;
    for (const double y0_m : {0.0, 1.9}) {
        for (int iy = static_cast<int>(y0_m / kCell_m); iy < (y0_m == 0.0 ? 40 : kSide); ++iy)
            for (int ix = 54; ix < 68; ++ix)
                floor.height_m.at(ix, iy) = 0.15F + 0.4F * static_cast<float>((3 * ix + iy) % 3);
    }
    const auto found = bottlenecks(floor);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found[0].middle_m.y(), 1.45, kBlock_m);
}

/// In a corner the nearest walls stand at right angles to each other.
TEST(Bottlenecks, NoneBetweenWallsThatDoNotFaceEachOther) {
    EXPECT_TRUE(bottlenecks(Floor().wall(0.3, 0.3, 0.4, 1.5).wall(0.3, 0.3, 1.5, 0.4)).empty());
    EXPECT_TRUE(bottlenecks(Floor().wall(0.3, 0.3, 0.4, 1.5)).empty());
    EXPECT_TRUE(bottlenecks(Floor()).empty());
}

}  // namespace
}  // namespace surefoot::stairs
