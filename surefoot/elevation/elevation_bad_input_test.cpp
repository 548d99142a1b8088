// SPDX-License-Identifier: Apache-2.0
// Invalid measurements must be counted as rejected, or refused with a message; no cell may become
// partly known. Pixels: depth_fusion_test; regions: map_region_test; lost motion:
// elevation_map_test.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "surefoot/core/unknown.hpp"
#include "surefoot/elevation/elevation_map.hpp"

namespace surefoot::elevation {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr double kNanPose = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr float kVar_m2 = 1e-5F;

Pose body_at(double x_m, double y_m = 0.0) {
    return {Eigen::Quaterniond::Identity(), {x_m, y_m, 1.0}};
}

/// 16 points of one cell, one metre ahead of a body one metre above the floor.
std::vector<MeasuredPoint> floor_ahead(const Eigen::Vector3f& off_m = Eigen::Vector3f::Zero()) {
    std::vector<MeasuredPoint> points;
    for (int i = 0; i < 16; ++i) {
        const Eigen::Vector3f p_m(1.001F + 0.005F * static_cast<float>(i % 4),
                                  0.001F + 0.005F * static_cast<float>(i / 4),
                                  -1.0F);
        points.push_back({p_m + off_m, kVar_m2, kVar_m2});
    }
    return points;
}

/// Unknown cells hold no values; known cells have a finite height, a variance and a count.
void expect_whole(const ElevationMap& map, const std::string& after) {
    const ElevationLayers& layers = map.layers();
    for (std::size_t i = 0; i < layers.height_m.size(); ++i) {
        const float height_m = layers.height_m.data()[i];
        const float var_m2 = layers.height_var_m2.data()[i];
        if (std::isnan(height_m)) {
            ASSERT_TRUE(std::isnan(var_m2)) << after << ", cell " << i;
            ASSERT_EQ(layers.count.data()[i], 0U) << after << ", cell " << i;
            ASSERT_TRUE(std::isnan(layers.confidence.data()[i])) << after << ", cell " << i;
        } else {
            ASSERT_TRUE(std::isfinite(height_m)) << after << ", cell " << i;
            ASSERT_GT(var_m2, 0.0F) << after << ", cell " << i;
            ASSERT_GT(layers.count.data()[i], 0U) << after << ", cell " << i;
            ASSERT_GE(layers.horizontal_drift_m.data()[i], 0.0F) << after << ", cell " << i;
        }
    }
}

/// Returns the smallest variance of a known cell; NaN without known cells.
float least_variance(const ElevationMap& map) {
    float least_m2 = kNanF;
    for (std::size_t i = 0; i < map.layers().height_m.size(); ++i)
        least_m2 = std::fmin(least_m2, map.layers().height_var_m2.data()[i]);
    return least_m2;
}

/// Both cuts are off: only the map itself protects against the points.
ElevationConfig open_config() {
    ElevationConfig config;
    config.prefilter.range = false;
    config.prefilter.height = false;
    return config;
}

TEST(BadInput, PointsThatAreNoMeasurementAreNotCounted) {
    std::vector<MeasuredPoint> points;
    for (const float bad : {kNanF, kInf, -kInf}) {
        for (int axis = 0; axis < 3; ++axis) {
            points.push_back(floor_ahead().front());
            points.back().p_sensor_m[axis] = bad;
        }
    }
    for (const float bad : {kNanF, kInf, -kInf, -1e-6F, -1e30F}) {
        points.push_back({{1.0F, 0.0F, -1.0F}, bad, kVar_m2});
        points.push_back({{1.0F, 0.0F, -1.0F}, kVar_m2, bad});
    }
    points.push_back({{0.0F, 0.0F, 0.0F}, kVar_m2, kVar_m2});  // the sensor itself
    ElevationMap map(open_config());
    const FusionCounts counts = map.add_points(points, {}, body_at(0.0), 0);
    EXPECT_EQ(counts.points, 0);
    EXPECT_EQ(counts.cells_measured, 0);
    EXPECT_EQ(map.known_cells(), 0);
}

TEST(BadInput, PointsBeyondAllBoundsAreCountedAndLieOutside) {
    for (const float far_m : {1e6F, 1e30F, 3e38F}) {
        for (const bool cuts : {false, true}) {
            ElevationMap map(cuts ? ElevationConfig{} : open_config());
            std::vector<MeasuredPoint> points;
            for (int axis = 0; axis < 2; ++axis) {
                for (const float sign : {-1.0F, 1.0F}) {
                    points.push_back({{1.0F, 0.0F, -1.0F}, kVar_m2, kVar_m2});
                    points.back().p_sensor_m[axis] = sign * far_m;
                }
            }
            const FusionCounts counts = map.add_points(points, {}, body_at(0.0), 0);
            EXPECT_EQ(counts.points, 4) << far_m;
            EXPECT_EQ(counts.gated_range + counts.outside, 4) << far_m;
            EXPECT_EQ(map.known_cells(), 0) << far_m;
        }
    }
}

TEST(BadInput, HeightsAndVariancesBeyondAllBoundsLeaveNoHalfKnownCell) {
    for (const float z_m : {1e10F, -1e30F, 3e38F}) {
        ElevationMap map(open_config());
        map.add_points(floor_ahead(), {}, body_at(0.0), 0);
        for (int look = 0; look < 40; ++look) {  // until the cell is replaced
            std::vector<MeasuredPoint> points = floor_ahead();
            for (MeasuredPoint& point : points) point.p_sensor_m.z() = z_m;
            map.add_points(points, {}, body_at(0.01 * look), look);
            expect_whole(map, "height " + std::to_string(z_m));
        }
    }
    for (const float var_m2 : {0.0F, 1e-44F, 1e20F, 3e38F}) {
        ElevationMap map(open_config());
        for (int look = 0; look < 5; ++look) {
            std::vector<MeasuredPoint> points = floor_ahead();
            for (MeasuredPoint& point : points) {
                point.along_var_m2 = var_m2;
                point.lateral_var_m2 = var_m2;
            }
            map.add_points(points, {}, body_at(0.01 * look), look);
            expect_whole(map, "variance " + std::to_string(var_m2));
        }
    }
}

TEST(BadInput, AMotionAsUncertainAsFloatsEndLeavesNoHalfKnownCell) {
    for (const double var : {1e10, 1e13, 3e38, 1e100, 1e300}) {
        ElevationMap map({});
        map.add_points(floor_ahead(), {}, body_at(0.0), 0);
        map.follow(body_at(0.1), var * Matrix6::Identity());
        expect_whole(map, "before a look, a motion's variance of " + std::to_string(var));
        EXPECT_FALSE(least_variance(map) < 1e9F) << var << ": vanished";
        map.add_points(floor_ahead({-0.1F, 0.0F, 0.0F}), {}, body_at(0.1), kSecond_ns);
        expect_whole(map, "a motion's variance of " + std::to_string(var));
        const auto cell = map.geometry().cell_at(1.01, 0.01);
        ASSERT_TRUE(cell);
        EXPECT_NEAR(map.layers().height_m.at(cell->ix, cell->iy), 0.0F, 1e-6F) << var;
        EXPECT_LT(map.layers().height_var_m2.at(cell->ix, cell->iy), 1e-4F)
            << var << ": the new look counts";
    }
}

TEST(BadInput, PosesThatAreNoneAddNothingAndForgetNothing) {
    ElevationMap map({});
    map.add_points(floor_ahead(), {}, body_at(0.0), 0);
    ASSERT_EQ(map.known_cells(), 1);
    const Pose nowhere = body_at(kNanPose);
    Pose turned;
    turned.rotation.coeffs().setConstant(kNanPose);
    for (const Pose& bad : {nowhere, turned}) {
        EXPECT_EQ(map.add_points(floor_ahead(), bad, body_at(0.0), 1).points, 0);
        EXPECT_EQ(map.add_points(floor_ahead(), {}, bad, 1).points, 0);
        DepthImage depth;
        depth.resize(4, 4);
        EXPECT_EQ(map.add({}, bad, depth, 1).points, 0);
        EXPECT_EQ(map.known_cells(), 1);
    }
}

TEST(BadInput, ABodyBeyondAllBoundsIsFollowedWithoutHarmAndSoIsItsWayBack) {
    ElevationMap map({});
    map.add_points(floor_ahead(), {}, body_at(0.0), 0);
    for (const double x_m : {1e9, 1e30, -1e300}) {
        map.follow(body_at(x_m, -x_m), 1e-6 * Matrix6::Identity());
        map.add_points(floor_ahead(), {}, body_at(x_m, -x_m), 1);
        expect_whole(map, "a body at " + std::to_string(x_m));
    }
    // So far away, coordinates cannot distinguish neighbouring cells. Come back and start with an
    // empty map.
    for (int step = 0; step < 8; ++step) map.follow(body_at(0.0), Matrix6::Zero());
    map.add_points(floor_ahead(), {}, body_at(0.0), 2);
    EXPECT_EQ(map.known_cells(), 1);
}

TEST(BadInput, TimeThatGoesBackIsJustATime) {
    for (const double scan_s : {0.0, 1.0}) {
        ElevationConfig config;
        config.fusion.scan_duration_s = scan_s;
        ElevationMap map(config);
        for (const std::int64_t time_ns : {100 * kSecond_ns, std::int64_t{0}, -100 * kSecond_ns}) {
            const FusionCounts counts = map.add_points(floor_ahead(), {}, body_at(0.0), time_ns);
            EXPECT_EQ(counts.cells_measured, 1) << time_ns;
            expect_whole(map, "time " + std::to_string(time_ns));
            const auto cell = map.geometry().cell_at(1.01, 0.01);
            ASSERT_TRUE(cell);
            EXPECT_EQ(map.layers().seen_ns.at(cell->ix, cell->iy), time_ns) << "what it last was";
        }
    }
}

TEST(BadInput, AMapOfOneCellIsAMap) {
    ElevationConfig config;
    config.length_m = config.resolution_m;
    ASSERT_FALSE(config.problem());
    ElevationMap map(config);
    ASSERT_EQ(map.geometry().nx, 1);
    ASSERT_EQ(map.geometry().ny, 1);
    map.follow(body_at(1.0), 1e-6 * Matrix6::Identity());
    EXPECT_EQ(map.add_points(floor_ahead(), {}, body_at(1.0), 0).outside, 16);
    map.follow(body_at(2.0), 1e-6 * Matrix6::Identity());
    EXPECT_EQ(map.add_points(floor_ahead(), {}, body_at(1.0), 0).cells_new, 1);
    EXPECT_EQ(map.known_cells(), 1);
    map.follow(body_at(3.0), 1e-6 * Matrix6::Identity());
    EXPECT_EQ(map.known_cells(), 0);
}

TEST(BadInput, ImagesOfNoneAndOneAndOfInvalidPixelsAddNothing) {
    camera::RectifiedRig rig;
    rig.fx_px = rig.fy_px = 300.0;
    rig.baseline_m = 0.12;
    rig.T_body_camera = T_body_optical();
    for (const auto& [width, height] : {std::pair{0, 0}, {1, 1}, {1, 40}, {40, 1}, {30, 20}}) {
        rig.width = width;
        rig.height = height;
        DepthImage depth;
        depth.resize(width, height);
        depth.sigma_px.fill(0.2F);
        depth.outlier_probability.fill(0.0F);
        for (const float disparity_px : {kNanF, kInf, -kInf, 0.0F, -3.0F, 1e-44F, 3e38F}) {
            depth.disparity_px.fill(disparity_px);
            ElevationMap map({});
            map.add(rig, body_at(0.0), depth, 0);
            EXPECT_EQ(map.known_cells(), 0) << width << " x " << height << ' ' << disparity_px;
        }
        for (const float sigma_px : {-0.2F, kInf, -kInf}) {
            depth.disparity_px.fill(20.0F);
            depth.sigma_px.fill(sigma_px);
            ElevationMap map({});
            const FusionCounts counts = map.add(rig, body_at(0.0), depth, 0);
            EXPECT_EQ(counts.gated_confidence, counts.points) << sigma_px;
            EXPECT_EQ(map.known_cells(), 0) << sigma_px;
        }
    }
}

TEST(BadInput, RigsThatMeasureNothingAddNothing) {
    DepthImage depth;
    depth.resize(32, 24);
    depth.disparity_px.fill(30.0F);
    depth.sigma_px.fill(0.2F);
    depth.outlier_probability.fill(0.0F);
    for (const double bad : {kNanPose, 0.0, static_cast<double>(kInf)}) {
        for (const bool focal : {false, true}) {
            camera::RectifiedRig rig;
            rig.width = 32;
            rig.height = 24;
            rig.fx_px = rig.fy_px = focal ? bad : 300.0;
            rig.baseline_m = focal ? 0.12 : bad;
            rig.T_body_camera = T_body_optical();
            ElevationMap map({});
            map.add(rig, body_at(0.0), depth, 0);
            EXPECT_EQ(map.known_cells(), 0) << bad << (focal ? " focal length" : " baseline");
        }
    }
}

TEST(BadInput, SizesThatMakeNoMapAreNamed) {
    const auto refused = [](double resolution_m, double length_m, const char* word) {
        ElevationConfig config;
        config.resolution_m = resolution_m;
        config.length_m = length_m;
        const auto problem = config.problem();
        ASSERT_TRUE(problem) << resolution_m << ' ' << length_m;
        EXPECT_NE(problem->find(word), std::string::npos) << *problem;
    };
    const double kNanSize = kNanPose;
    const double kInfSize = static_cast<double>(kInf);
    for (const double bad : {0.0, -0.025, kNanSize, kInfSize}) {
        refused(bad, 6.0, "elevation.resolution_m");
    }
    for (const double bad : {0.0, -6.0, 0.02, kNanSize, kInfSize}) {
        refused(0.025, bad, "elevation.length_m");
    }
    refused(1e-9, 6.0, "cells per side");
}

}  // namespace
}  // namespace surefoot::elevation
