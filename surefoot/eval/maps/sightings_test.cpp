// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/maps/sightings.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/core/unknown.hpp"

namespace surefoot::eval {
namespace {

constexpr PinholeView kView{672, 376, 350.0, 350.0, 335.5, 187.5};

/// 1 m above the floor at x, looking straight ahead or turned about z.
StampedPose camera_at(double x_m, double yaw_rad = 0.0) {
    Pose T_world_body{exp_so3({0.0, 0.0, yaw_rad}), {x_m, 0.0, 1.0}};
    return {0, T_world_body * T_body_optical()};
}

TEST(Sightings, ColumnsAndRangesByHand) {
    const grid::GridGeometry geometry{0.5, 20, 9, {0.0, -2.25}};  // centres y = -2 .. 2
    grid::Layer height(20, 9, 0.0F);
    height.at(5, 4) = kNanF;
    const Sightings seen = last_sightings(geometry, height, {camera_at(0.0)}, kView, 4.0);
    // Centre (3.25, 0): straight ahead. Row 1 m below: v = 187.5 + 350 / 3.25 is inside.
    EXPECT_NEAR(static_cast<double>(seen.column_px.at(6, 4)), 335.5, 1e-4);
    EXPECT_NEAR(static_cast<double>(seen.range_m.at(6, 4)), 3.25, 1e-6);
    // Centre (3.25, 1): left of the middle by 350 / 3.25.
    EXPECT_NEAR(static_cast<double>(seen.column_px.at(6, 6)), 335.5 - 350.0 / 3.25, 1e-4);
    EXPECT_NEAR(static_cast<double>(seen.range_m.at(6, 6)), std::hypot(3.25, 1.0), 1e-6);
    EXPECT_TRUE(std::isnan(seen.column_px.at(5, 4)));  // unknown height
    EXPECT_TRUE(std::isnan(seen.column_px.at(8, 4)));  // 4.25 m: beyond the depth
    EXPECT_FALSE(std::isnan(seen.column_px.at(7, 4)));
    EXPECT_TRUE(std::isnan(seen.column_px.at(3, 4)));  // 1.75 m: v = 387 is below the image
    EXPECT_FALSE(std::isnan(seen.column_px.at(4, 0)));
}

TEST(Sightings, TheLatestPoseCounts) {
    const grid::GridGeometry geometry{0.5, 20, 1, {0.0, -0.25}};
    const grid::Layer height(20, 1, 0.0F);
    const Trajectory there_and_round = {camera_at(0.0), camera_at(2.0), camera_at(2.0, M_PI)};
    const Sightings seen = last_sightings(geometry, height, there_and_round, kView, 6.0);
    EXPECT_NEAR(static_cast<double>(seen.range_m.at(10, 0)), 3.25, 1e-6);  // seen from 0 m too
    EXPECT_NEAR(static_cast<double>(seen.range_m.at(6, 0)), 3.25, 1e-6);   // 3.25 m, from 0 m
    // Behind every camera but the last, which is too near to see it.
    EXPECT_TRUE(std::isnan(seen.range_m.at(1, 0)));
}

TEST(Sightings, NothingSeen) {
    const grid::GridGeometry geometry{0.5, 4, 4, {0.0, 0.0}};
    const grid::Layer height(4, 4, 0.0F);
    const Sightings seen = last_sightings(geometry, height, {}, kView, 5.0);
    for (std::size_t i = 0; i < height.size(); ++i) EXPECT_TRUE(std::isnan(seen.range_m.data()[i]));
    const Sightings empty = last_sightings({}, {}, {camera_at(0.0)}, kView, 5.0);
    EXPECT_TRUE(empty.column_px.empty());
}

TEST(Sightings, DistanceIsToTheNearestPositionOnTheGround) {
    const grid::GridGeometry geometry{1.0, 3, 2, {0.0, 0.0}};
    Trajectory trajectory(2);
    trajectory[0].T_world_body.translation_m = {0.5, 0.5, 7.0};  // height plays no part
    trajectory[1].T_world_body.translation_m = {2.5, 0.5, -7.0};
    const grid::Layer distance = distance_to(geometry, trajectory);
    EXPECT_EQ(distance.at(0, 0), 0.0F);
    EXPECT_EQ(distance.at(1, 0), 1.0F);
    EXPECT_EQ(distance.at(2, 0), 0.0F);
    EXPECT_EQ(distance.at(2, 1), 1.0F);
    EXPECT_NEAR(static_cast<double>(distance.at(1, 1)), std::sqrt(2.0), 1e-6);
    EXPECT_TRUE(std::isnan(distance_to(geometry, {}).at(0, 0)));
}

}  // namespace
}  // namespace surefoot::eval
