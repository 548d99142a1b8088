// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/region/region_transfer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "surefoot/elevation/elevation_map.hpp"
#include "surefoot/elevation/motion/motion_update.hpp"

namespace surefoot::elevation {
namespace {

constexpr std::int64_t kFrame_ns = 66'666'667;
/// Float arithmetic of a row against double arithmetic of a cell: a few roundings of 2^-24.
constexpr double kRowRounding = 1e-6;

Pose body_at(double x_m, double y_m, double yaw_rad = 0.0) {
    return {exp_so3({0.0, 0.0, yaw_rad}), {x_m, y_m, 1.0}};
}

ElevationConfig exact_config() {
    ElevationConfig config;
    config.camera_tilt_sigma_rad = 0.0;
    config.reduction.systematic_sigma_m = 0.0;
    return config;
}

/// Adds flat ground of 0.1 m x 0.1 m, seen from the body's origin.
void see_patch(ElevationMap& map,
               const Pose& T_odom_body,
               double x_m,
               double y_m,
               double z_m,
               std::int64_t time_ns) {
    std::vector<MeasuredPoint> points;
    for (int i = -10; i < 10; ++i) {
        for (int j = -10; j < 10; ++j) {
            const Eigen::Vector3d p_m(x_m + 0.0025 + 0.005 * i, y_m + 0.0025 + 0.005 * j, z_m);
            points.push_back({(T_odom_body.inverse() * p_m).cast<float>(), 2.5e-5F, 2.5e-5F});
        }
    }
    map.add_points(points, {}, T_odom_body, time_ns);
}

/// A map that observed two patches, moved with an uncertain motion, and observed one of them again.
ElevationMap walked_map() {
    ElevationMap map(exact_config());
    see_patch(map, body_at(0, 0), 1.0, 0.5, 0.03, kFrame_ns);
    see_patch(map, body_at(0, 0), -1.0, -0.5, -0.02, kFrame_ns);
    Matrix6 covariance = Matrix6::Zero();
    covariance.diagonal() << 1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 4e-6;
    map.follow(body_at(0.4, 0.1), covariance);
    see_patch(map, body_at(0.4, 0.1), 1.0, 0.5, 0.031, 2 * kFrame_ns);
    return map;
}

std::size_t index_at(const grid::GridGeometry& geometry, double x_m, double y_m) {
    const auto cell = geometry.cell_at(x_m, y_m);
    return static_cast<std::size_t>(cell->iy * geometry.nx + cell->ix);
}

TEST(RegionOfMap, HoldsEveryLayerOfEveryCell) {
    const ElevationMap map = walked_map();
    const grid::MapRegion region = region_of(map);
    EXPECT_EQ(region.problem(), std::nullopt);
    EXPECT_EQ(region.known_cells(), 32);
    EXPECT_EQ(region.geometry().origin_m, map.geometry().origin_m);
    const std::size_t seen_twice = index_at(map.geometry(), 1.01, 0.51);
    EXPECT_EQ(region.count.data()[seen_twice], 2U);
    EXPECT_EQ(region.seen_ns.data()[seen_twice], 2 * kFrame_ns);
    const std::size_t remembered = index_at(map.geometry(), -0.99, -0.49);
    EXPECT_GT(region.horizontal_drift_m.data()[remembered], 0.0F);
    EXPECT_EQ(region.height_var_m2.data()[remembered],
              map.layers().height_var_m2.data()[remembered]);
}

TEST(RegionOfMap, ACellOfFewPointsIsOneToo) {
    ElevationMap map(exact_config());
    std::vector<MeasuredPoint> points;
    for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3d p_m(0.01, 0.01, 0.004 * i);
        points.push_back({(body_at(0, 0).inverse() * p_m).cast<float>(), 2.5e-5F, 2.5e-5F});
    }
    map.add_points(points, {}, body_at(0, 0), kFrame_ns);
    const grid::MapRegion region = region_of(map);
    ASSERT_EQ(region.known_cells(), 1);
    const std::size_t i = index_at(region.geometry(), 0.01, 0.01);
    EXPECT_GT(region.lowest_m.data()[i], region.highest_m.data()[i]);
    EXPECT_EQ(region.problem(), std::nullopt);
}

TEST(RegionOfMap, AWindowMayLieBeyondTheMap) {
    const ElevationMap map = walked_map();
    const grid::LatticeBox window{30, 10, 300, 25};  // holds the patch around (1.0, 0.5) m
    const grid::MapRegion region = region_of(map, window);
    EXPECT_EQ(region.problem(), std::nullopt);
    EXPECT_EQ(region.box, window);
    EXPECT_EQ(region.known_cells(), 16);
    EXPECT_EQ(region.height_m.data()[index_at(region.geometry(), 1.01, 0.51)],
              map.layers().height_m.data()[index_at(map.geometry(), 1.01, 0.51)]);
}

TEST(PayForMotion, EveryCellGetsWhatTheClosedFormSays) {
    grid::MapRegion region = region_of(walked_map());
    const grid::MapRegion before = region;
    const Pose T_odom_body = body_at(0.7, -0.3, 0.6);
    Matrix6 covariance = Matrix6::Zero();
    covariance.diagonal() << 4e-4, 1e-4, 9e-6, 1e-5, 2e-5, 3e-4;
    covariance(0, 5) = covariance(5, 0) = 1e-4;
    ASSERT_TRUE(pay_for_motion(region, T_odom_body, covariance).ok());
    const MotionNoise noise(covariance, T_odom_body.R());
    for (const auto& [x_m, y_m] : {std::pair{1.01, 0.51}, std::pair{-0.99, -0.49}}) {
        const grid::GridGeometry geometry = region.geometry();
        const std::size_t i = index_at(geometry, x_m, y_m);
        const auto cell = geometry.cell_at(x_m, y_m);
        const Eigen::Vector2d r_m = geometry.center_m(*cell) - T_odom_body.translation_m.head<2>();
        const double z_m = double{before.height_m.data()[i]} - T_odom_body.translation_m.z();
        const double var_m2 =
            double{before.height_var_m2.data()[i]} + noise.height_var_m2(r_m.x(), r_m.y());
        EXPECT_NEAR(region.height_var_m2.data()[i], var_m2, kRowRounding * var_m2);
        const double drift_m = double{before.horizontal_drift_m.data()[i]};
        const double drift_sq = drift_m * drift_m + noise.horizontal_var_m2(r_m.x(), r_m.y(), z_m);
        EXPECT_NEAR(region.horizontal_drift_m.data()[i], std::sqrt(drift_sq), kRowRounding);
        EXPECT_EQ(region.height_m.data()[i], before.height_m.data()[i]);
    }
    EXPECT_EQ(region.T_frame_body.translation_m, T_odom_body.translation_m);
}

TEST(PayForMotion, WhatIsKnownOfNothingIsRefusedAndWhatLeavesTheRangeIsForgotten) {
    grid::MapRegion region = region_of(walked_map());
    Matrix6 covariance = Matrix6::Zero();
    covariance(2, 2) = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(pay_for_motion(region, body_at(0, 0), covariance).ok());
    Pose nowhere;
    nowhere.translation_m.y() = std::nan("");
    EXPECT_FALSE(pay_for_motion(region, nowhere, Matrix6::Zero()).ok());
    EXPECT_EQ(region.known_cells(), 32);
    covariance(2, 2) = 1e39;
    ASSERT_TRUE(pay_for_motion(region, body_at(0, 0), covariance).ok());
    EXPECT_EQ(region.known_cells(), 0);
    EXPECT_EQ(region.problem(), std::nullopt);
}

TEST(InsertRegion, FillsUnknownCellsAloneAndLetsThemPayForThePlacement) {
    const grid::MapRegion region = region_of(walked_map());
    ElevationMap map(exact_config());
    const Pose T_odom_body = body_at(0.2, 0.0, 0.3);
    map.follow(T_odom_body, Matrix6::Zero());
    see_patch(map, T_odom_body, 1.0, 0.5, 0.05, 7 * kFrame_ns);
    const std::size_t seen = index_at(map.geometry(), 1.01, 0.51);
    const std::size_t filled = index_at(map.geometry(), -0.99, -0.49);
    const float seen_height_m = map.layers().height_m.data()[seen];

    Matrix6 placement = Matrix6::Zero();
    placement.diagonal() << 1e-4, 1e-4, 4e-6, 1e-6, 1e-6, 1e-6;
    const auto count = map.insert(region, T_odom_body, placement);
    ASSERT_TRUE(count.ok());
    EXPECT_EQ(*count, 16);
    EXPECT_EQ(map.layers().height_m.data()[seen], seen_height_m);
    EXPECT_EQ(map.layers().seen_ns.data()[seen], 7 * kFrame_ns);
    const std::size_t from = index_at(region.geometry(), -0.99, -0.49);
    EXPECT_EQ(map.layers().height_m.data()[filled], region.height_m.data()[from]);
    EXPECT_EQ(map.layers().seen_ns.data()[filled], 0);
    EXPECT_GT(map.layers().height_var_m2.data()[filled], region.height_var_m2.data()[from] + 4e-6F);
    EXPECT_GT(map.layers().horizontal_drift_m.data()[filled], 0.01F);
}

TEST(InsertRegion, APlacementThatIsSaidToBePerfectStillCostsTheStatedLeast) {
    const grid::MapRegion region = region_of(walked_map());
    ElevationMap map(exact_config());
    ASSERT_TRUE(map.insert(region, body_at(0, 0, 0.7), Matrix6::Zero()).ok());
    EXPECT_EQ(map.known_cells(), 32);
    const std::size_t i = index_at(map.geometry(), 1.01, 0.51);  // drift 0 in the region
    const double least_var_m2 = map.config().fusion.min_height_var_m2;
    const std::size_t from = index_at(region.geometry(), 1.01, 0.51);
    const double var_m2 = double{region.height_var_m2.data()[from]} + least_var_m2;
    EXPECT_NEAR(map.layers().height_var_m2.data()[i], var_m2, kRowRounding * var_m2);
    EXPECT_NEAR(map.layers().horizontal_drift_m.data()[i], 0.025 / std::sqrt(12.0), kRowRounding);
}

TEST(InsertRegion, TheFirstLookAtARememberedCellIsNewInformation) {
    ElevationMap map(exact_config());
    ASSERT_TRUE(map.insert(region_of(walked_map()), body_at(0, 0), Matrix6::Zero()).ok());
    const std::size_t i = index_at(map.geometry(), 1.01, 0.51);
    const float before_m2 = map.layers().height_var_m2.data()[i];
    see_patch(map, body_at(0, 0), 1.0, 0.5, 0.03, 9 * kFrame_ns);
    EXPECT_LT(map.layers().height_var_m2.data()[i], before_m2);
    EXPECT_EQ(map.layers().seen_ns.data()[i], 9 * kFrame_ns);
    EXPECT_EQ(map.layers().horizontal_drift_m.data()[i], 0.0F);
}

TEST(InsertRegion, WhatHangsOverTheGroundComesAlong) {
    grid::MapRegion region = region_of(walked_map());
    region.clearance_m.data()[index_at(region.geometry(), 1.01, 0.51)] = 0.7F;
    ElevationMap map(exact_config());
    ASSERT_TRUE(map.insert(region, body_at(0, 0), Matrix6::Zero()).ok());
    const std::size_t i = index_at(map.geometry(), 1.01, 0.51);
    EXPECT_NEAR(map.layers().clearance_m.data()[i], 0.7F, 1e-6F);  // two sums of floats below 1
    EXPECT_TRUE(std::isnan(map.layers().clearance_m.data()[i + 1]));
}

TEST(InsertRegion, AWrongRegionOrPlacementChangesNothing) {
    const grid::MapRegion region = region_of(walked_map());
    const auto refused = [](const grid::MapRegion& r, const Matrix6& covariance, const char* word) {
        ElevationMap map(exact_config());
        const auto result = map.insert(r, body_at(0, 0), covariance);
        ASSERT_FALSE(result.ok()) << word;
        EXPECT_NE(result.error().message.find(word), std::string::npos) << result.error().message;
        EXPECT_EQ(map.known_cells(), 0);
    };
    grid::MapRegion coarse = region;
    coarse.resolution_m = 0.05;
    refused(coarse, Matrix6::Zero(), "0.05 m cells cannot fill cells of 0.025 m");
    grid::MapRegion damaged = region;
    damaged.count.data()[0] = 1;
    refused(damaged, Matrix6::Zero(), "cell (0, 0)");
    refused(region, Matrix6::Constant(std::nan("")), "not finite");
}

}  // namespace
}  // namespace surefoot::elevation
