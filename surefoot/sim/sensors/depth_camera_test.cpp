// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/depth_camera.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "surefoot/sim/rendering/renderer.hpp"
#include "surefoot/sim/sensors/rigs.hpp"
#include "surefoot/sim/sensors/sensor_scenes_testing.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

DepthCameraConfig noiseless() {
    DepthCameraConfig config;
    config.axial_offset_m = 0.0;
    config.axial_slope_1_m = 0.0;
    config.axial_angle = 0.0;
    config.lateral_share = 0.0;
    config.disparity_step_px = 0.0;
    config.projector_x_m = 0.0;
    config.least_return = 0.0;
    return config;
}

camera::Camera small_camera() {
    camera::PinholeRadTan lens;
    lens.fx_px = 200.0;
    lens.fy_px = 200.0;
    lens.cx_px = 119.5;
    lens.cy_px = 89.5;
    return {lens, 240, 180};
}

DepthFrame shot(const Scene& scene,
                const DepthCameraConfig& config,
                const Pose& T_world_camera,
                const camera::Camera& camera = small_camera()) {
    Serial serial;
    DepthFrame out;
    DepthCamera::make(scene, camera, config, 1).value().render(T_world_camera, 0, serial, out);
    return out;
}

/// Unbiased standard deviation of the known pixels about a constant.
struct Spread {
    double mean_m = 0.0;
    double sigma_m = 0.0;
    int count = 0;
};
Spread spread(const Image<float>& image) {
    double sum = 0.0;
    double squares = 0.0;
    Spread result;
    for (std::size_t i = 0; i < image.size(); ++i) {
        const auto value = static_cast<double>(image.data()[i]);
        if (std::isnan(value)) continue;
        sum += value;
        squares += value * value;
        ++result.count;
    }
    result.mean_m = sum / result.count;
    result.sigma_m = std::sqrt(squares / result.count - result.mean_m * result.mean_m);
    return result;
}

TEST(DepthCameraTest, WithoutErrorsItIsTheExactDepthOfTheRenderer) {
    const Scene scene = test::scene_with_box();
    Pose T_world_body;
    T_world_body.translation_m = {0.0, 0.0, kBodyHeight_m};
    const Pose T_world_camera = T_world_body * rig_preset("zed_vga").value().body_from_left();
    DepthCameraConfig config = noiseless();
    config.min_range_m = 0.01;
    config.max_range_m = 100.0;
    config.max_incidence_deg = 90.0;
    const DepthFrame frame = shot(scene, config, T_world_camera);
    camera::RectifiedRig rig{240, 180, 200.0, 200.0, 119.5, 89.5, 0.1, {}};
    Serial serial;
    const Image<float> exact_px = rectified_disparity_px(scene, rig, T_world_camera, serial);
    int known = 0;
    for (std::size_t i = 0; i < exact_px.size(); ++i) {
        const float disparity_px = exact_px.data()[i];
        EXPECT_EQ(std::isnan(frame.depth_m.data()[i]), std::isnan(disparity_px)) << i;
        if (std::isnan(disparity_px)) continue;
        // Two roundings to float.
        const double depth_m = 20.0 / static_cast<double>(disparity_px);
        EXPECT_NEAR(static_cast<double>(frame.depth_m.data()[i]), depth_m, 2e-7 * depth_m);
        ++known;
    }
    EXPECT_GT(known, 20000);
}

TEST(DepthCameraTest, NoiseGrowsWithDepthAsTheModelSays) {
    for (const double depth_m : {0.6, 1.5, 2.8}) {
        for (const auto kind : {DepthCameraKind::kinect_v1, DepthCameraKind::kinect_v2}) {
            const char* name = kDepthCameraNames[static_cast<int>(kind)];
            const DepthCameraPreset kinect = depth_camera_preset(kind);
            const Scene scene = test::wall_ahead(depth_m);
            const DepthFrame frame =
                shot(scene, kinect.config, test::level_camera(), kinect.camera);
            const Spread depth = spread(frame.depth_m);
            ASSERT_GT(depth.count, 200000) << name;
            const double far_m = depth_m - 0.4;
            const double model_m = 0.0012 + 0.0019 * far_m * far_m;
            // Angles up to 43 deg add 1 to 7 %: the mean of what the camera reports.
            const double reported_m = spread(frame.sigma_m).mean_m;
            EXPECT_GT(reported_m, model_m);
            EXPECT_LT(reported_m, 1.08 * model_m);
            EXPECT_NEAR(depth.sigma_m / reported_m, 1.0, 0.05) << name << " at " << depth_m;
            EXPECT_NEAR(depth.mean_m, depth_m, 0.05 * model_m) << name;
        }
    }
}

TEST(DepthCameraTest, StructuredLightHasStepsOfDisparity) {
    DepthCameraConfig config = noiseless();
    config.projector_x_m = 0.075;
    config.disparity_step_px = 0.125;
    const double depth_m = 2.0;
    const DepthFrame frame = shot(test::wall_ahead(depth_m), config, test::level_camera());
    const double step_m = depth_m * depth_m * 0.125 / (200.0 * 0.075);
    for (std::size_t i = 0; i < frame.depth_m.size(); ++i) {
        const auto measured_m = static_cast<double>(frame.depth_m.data()[i]);
        if (std::isnan(measured_m)) continue;
        const double steps = 15.0 / measured_m / 0.125;
        EXPECT_NEAR(steps, std::round(steps), 1e-4);
        EXPECT_LT(std::abs(measured_m - depth_m), 0.51 * step_m);
    }
}

/// A plate in front of a wall; projector to the right: its shadow on the wall lies to the left of
/// the plate, f b (1 / z_plate - 1 / z_wall) pixels wide.
TEST(DepthCameraTest, PlateThrowsAShadowAsWideAsGeometrySays) {
    DepthCameraConfig config = noiseless();
    config.projector_x_m = 0.075;
    const double expected_px = 200.0 * 0.075 * (1.0 / 1.0 - 1.0 / 2.0);
    const DepthFrame frame =
        shot(test::plate_before_wall(1.0, 2.0, 0.4), config, test::level_camera());
    const float* row = frame.depth_m.row(90);
    int plate_first = -1;
    int plate_last = -1;
    for (int u = 0; u < 240; ++u) {
        if (!(row[u] < 1.5F)) continue;
        if (plate_first < 0) plate_first = u;
        plate_last = u;
    }
    ASSERT_GT(plate_first, 0);
    int shadow_px = 0;
    while (std::isnan(row[plate_first - 1 - shadow_px])) ++shadow_px;
    EXPECT_NEAR(shadow_px, expected_px, 1.0);
    EXPECT_FALSE(std::isnan(row[plate_last + 1])) << "no shadow on the projector's side";
    config.projector_x_m = -0.075;
    const DepthFrame other =
        shot(test::plate_before_wall(1.0, 2.0, 0.4), config, test::level_camera());
    EXPECT_FALSE(std::isnan(other.depth_m.row(90)[plate_first - 1]));
    EXPECT_TRUE(std::isnan(other.depth_m.row(90)[plate_last + 2]));
}

TEST(DepthCameraTest, LateralNoiseFraysEdgesAndNothingElse) {
    DepthCameraConfig config = noiseless();
    config.lateral_share = 1.5 / 200.0;  // 1.5 px
    const Scene scene = test::plate_before_wall(1.0, 2.0, 0.4);
    const DepthFrame frayed = shot(scene, config, test::level_camera());
    const DepthFrame sharp = shot(scene, noiseless(), test::level_camera());
    int moved = 0;
    int rows_moved = 0;
    for (int v = 0; v < 180; ++v) {
        int first = -1;
        for (int u = 0; u < 240; ++u) {
            if (frayed.depth_m.row(v)[u] == sharp.depth_m.row(v)[u]) continue;
            ++moved;
            bool edge = false;
            for (int dv = -3; dv <= 3; ++dv) {
                for (int du = -3; du <= 3; ++du) {
                    if (!sharp.depth_m.contains(u + du, v + dv)) continue;
                    const float there_m = sharp.depth_m.at(u + du, v + dv);
                    edge = edge || std::abs(there_m - sharp.depth_m.row(v)[u]) > 0.5F;
                }
            }
            EXPECT_TRUE(edge) << u << " " << v;
            first = u;
        }
        rows_moved += first >= 0 ? 1 : 0;
    }
    EXPECT_GT(moved, 100);
    EXPECT_GT(rows_moved, 50);
}

/// Two floors with a drop between them, seen from above: pixels either stay or jump over the edge
/// (0.15 m lower, by more than 0.2 m in depth); none slides along its floor.
TEST(DepthCameraTest, LateralNoiseMovesNothingAlongASurface) {
    DepthCameraConfig config = noiseless();
    config.lateral_share = 1.5 / 200.0;
    Pose T_world_camera = T_body_optical();
    T_world_camera.rotation =
        Eigen::Quaterniond(Eigen::AngleAxisd(0.55, Vector3d::UnitY())) * T_world_camera.rotation;
    T_world_camera.translation_m.z() = 1.0;
    const Scene scene = test::drop_ahead(1.5, 0.15);
    const DepthFrame frayed = shot(scene, config, T_world_camera);
    const DepthFrame sharp = shot(scene, noiseless(), T_world_camera);
    int jumped = 0;
    for (std::size_t i = 0; i < sharp.depth_m.size(); ++i) {
        const float change_m = std::abs(frayed.depth_m.data()[i] - sharp.depth_m.data()[i]);
        if (!(change_m > 0.0F)) continue;
        EXPECT_GT(change_m, 0.1F) << i;
        ++jumped;
    }
    EXPECT_GT(jumped, 50);
}

TEST(DepthCameraTest, TimeOfFlightMixesDepthsOnEdgesOnly) {
    DepthCameraConfig config = noiseless();
    config.mixes_edges = true;
    // The edge of the plate at x = 0.2013 m crosses the pixels at 119.5 +- 40.26.
    const DepthFrame frame =
        shot(test::plate_before_wall(1.0, 2.0, 0.4026), config, test::level_camera());
    int between = 0;
    for (int u = 0; u < 240; ++u) {
        const float depth_m = frame.depth_m.row(90)[u];
        const bool mixed = depth_m > 1.01F && depth_m < 1.99F;
        between += mixed ? 1 : 0;
        if (mixed) {
            EXPECT_NEAR(std::abs(u - 119.5), 40.26, 0.5) << u;
        }
    }
    EXPECT_GE(between, 1);
}

TEST(DepthCameraTest, DarkGrazingFarAndShinySurfacesAreLost) {
    const auto share_known = [](const Scene& scene, const DepthCameraConfig& config) {
        return spread(shot(scene, config, test::level_camera()).depth_m).count / (240.0 * 180.0);
    };
    DepthCameraConfig config = noiseless();
    EXPECT_EQ(share_known(test::wall_ahead(1.0), config), 1.0);
    EXPECT_EQ(share_known(test::wall_ahead(3.1), config), 0.0) << "beyond 3 m";
    EXPECT_EQ(share_known(test::wall_ahead(0.3), config), 0.0) << "nearer than 0.35 m";
    for (const Finish finish : {Finish::mirror, Finish::glass}) {
        Material shiny;
        shiny.finish = finish;
        EXPECT_EQ(share_known(test::wall_ahead(1.0, shiny), config), 0.0);
    }
    // Reflectance 0.03 seen nearly head-on, 0.06 needed: about half; cosine 0.8-1 over the image.
    Material dark;
    dark.albedo = 0.03;
    config.least_return = 0.06;
    const double known = share_known(test::wall_ahead(1.0, dark), config);
    EXPECT_GT(known, 0.5 * 0.80);
    EXPECT_LT(known, 0.5);
    // A floor 0.5 m below a level camera is grazed at atan(z / 0.5); 70 deg are at z = 1.37 m, the
    // row 200 * 0.5 / 1.37 = 72.8 px below the middle.
    config = noiseless();
    config.max_incidence_deg = 70.0;
    const DepthFrame floor = shot(test::floor_only(), config, test::level_camera(0.5));
    EXPECT_TRUE(std::isnan(floor.depth_m.at(120, 89 + 72)));
    EXPECT_FALSE(std::isnan(floor.depth_m.at(120, 89 + 75)));
}

TEST(DepthCameraTest, SameBytesForAnyExecutorAndOtherNoiseForAnotherFrame) {
    const Scene scene = test::scene_with_box();
    const DepthCamera camera =
        DepthCamera::make(
            scene, small_camera(), depth_camera_preset(DepthCameraKind::kinect_v1).config, 7)
            .value();
    const Pose T = test::level_camera(1.0);
    Serial serial;
    Backwards backwards;
    Threads threads(3);
    DepthFrame a;
    DepthFrame b;
    DepthFrame c;
    DepthFrame d;
    camera.render(T, 3, serial, a);
    camera.render(T, 3, backwards, b);
    camera.render(T, 3, threads, c);
    camera.render(T, 4, serial, d);
    EXPECT_TRUE(test::same_bytes(a.depth_m, b.depth_m));
    EXPECT_TRUE(test::same_bytes(a.depth_m, c.depth_m));
    EXPECT_TRUE(test::same_bytes(a.sigma_m, c.sigma_m));
    EXPECT_FALSE(test::same_bytes(a.depth_m, d.depth_m));
}

TEST(DepthCameraTest, WhatCannotBeIsRefusedInWords) {
    const Scene scene = test::floor_only();
    camera::Camera broken = small_camera();
    broken.width = 0;
    const auto camera = DepthCamera::make(scene, broken, {}, 1);
    ASSERT_FALSE(camera);
    EXPECT_NE(camera.error().message.find("simulator: depth camera: "), std::string::npos);
    DepthCameraConfig config;
    config.min_range_m = 5.0;
    const auto range = DepthCamera::make(scene, small_camera(), config, 1);
    ASSERT_FALSE(range);
    EXPECT_EQ(range.error().message,
              "simulator: depth camera: min_range_m = 5 must be below max_range_m = 3");
    for (const auto kind : {DepthCameraKind::kinect_v1, DepthCameraKind::kinect_v2}) {
        EXPECT_FALSE(depth_camera_preset(kind).camera.problem());
    }
}

}  // namespace
}  // namespace surefoot::sim
