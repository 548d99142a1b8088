// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/shutter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/sim/scenes/scenes.hpp"
#include "surefoot/sim/sensors/cameras_testing.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

constexpr double kDark = 0.1;
constexpr double kBright = 0.9;
constexpr double kWall_m = 1.0;  // in front of the camera
constexpr double kFocal_px = 85.0;

/// A bright plate (y > 0, the left half of the image) before a dark wall, both without texture.
Scene plate_scene() {
    Scene scene;
    Material plain;
    plain.contrast = 0.0;
    plain.albedo = kBright;
    const int bright = scene.add_material(plain);
    plain.albedo = kDark;
    const int dark = scene.add_material(plain);
    scene.add(make_box({kWall_m + 0.0005, 5.0}, {0.001, 10.0}, -5.0, 5.0), bright, Label::object);
    scene.add(make_box({kWall_m + 0.515, 0.0}, {1.0, 30.0}, -5.0, 5.0), dark, Label::wall);
    scene.light({1.0, 0.0});  // equal light from all sides: the plate's rim looks like its front
    return scene;
}

camera::StereoRig level_rig() {
    camera::StereoRig rig = test::small_rig();
    rig.T_body_left = looking_down({0.0, 0.0, 0.0}, 0.0);
    return rig;
}

/// Shares of the bright plate along a row: 1 on the left, 0 on the right.
std::vector<double> edge_profile(const CleanImage& image, int row) {
    const double dark = static_cast<double>(image.signal_dn.at(167, row));
    const double bright = static_cast<double>(image.signal_dn.at(0, row));
    std::vector<double> profile;
    for (int u = 0; u < 168; ++u) {
        profile.push_back((static_cast<double>(image.signal_dn.at(u, row)) - dark) /
                          (bright - dark));
    }
    return profile;
}

/// Number of pixels that the plate covers: position of the edge, from the left border of the image.
double edge_px(const std::vector<double>& profile) {
    return std::accumulate(profile.begin(), profile.end(), 0.0);
}

/// Variance of the edge's derivative, as if it were a distribution.
double edge_variance_px2(const std::vector<double>& profile) {
    double mean = 0.0;
    double square = 0.0;
    for (std::size_t u = 0; u + 1 < profile.size(); ++u) {
        const double weight = profile[u] - profile[u + 1];
        mean += weight * static_cast<double>(u);
        square += weight * static_cast<double>(u * u);
    }
    return square - mean * mean;
}

TEST(ShutterTest, OffsetsAreCentredOnTheStamp) {
    EXPECT_DOUBLE_EQ(row_offset_s(0, 100, 0.02), -0.0099);
    EXPECT_DOUBLE_EQ(row_offset_s(99, 100, 0.02), 0.0099);
    EXPECT_DOUBLE_EQ(row_offset_s(1, 3, 0.02), 0.0);
    EXPECT_TRUE(blur_offsets_s(0.01, 0).empty());
    EXPECT_EQ(blur_offsets_s(0.01, 1), std::vector<double>{0.0});
    const auto offsets_s = blur_offsets_s(0.01, 4);
    EXPECT_DOUBLE_EQ(offsets_s.front(), -0.00375);
    EXPECT_DOUBLE_EQ(offsets_s.back(), 0.00375);
}

TEST(ShutterTest, ACameraAtRestHasOneView) {
    const Pose T_body_camera = looking_down({0.1, 0.2, 0.0}, 0.3);
    const test::Steady still({}, Vector3d::Zero(), Vector3d::Zero());
    EXPECT_TRUE(ImageViews(still, T_body_camera, 1.0, 0.02, 94).single());
    const test::Steady moving({}, {0.1, 0.0, 0.0}, Vector3d::Zero());
    const ImageViews views(moving, T_body_camera, 1.0, 0.02, 94);
    EXPECT_FALSE(views.single());
    EXPECT_NEAR(views.row(0).origin_m.x(), 0.2 + 0.1 * row_offset_s(0, 94, 0.02), 1e-12);
    EXPECT_TRUE(ImageViews(moving, T_body_camera, 1.0, 0.0, 94).single());
}

TEST(ShutterTest, AMovingEdgeBlursOverTheWayOfTheExposure) {
    const Scene scene = plate_scene();
    constexpr double kExposure_s = 0.01;
    constexpr int kSamples = 16;
    Serial serial;
    // Within and beyond the reach of re-shading on known planes.
    for (const double way_px : {6.0, 24.0}) {
        const double speed_m_s = way_px / kFocal_px * kWall_m / kExposure_s;
        const test::Steady sideways({}, {0.0, speed_m_s, 0.0}, Vector3d::Zero());
        CameraConfig config = test::noiseless();
        const auto variance_px2 = [&](int samples) {
            config.shutter.blur_samples = samples;
            const Renderer renderer = Renderer::make(scene, level_rig(), config, 1).value();
            CleanPair pair;
            renderer.collect(sideways, 0.0, kExposure_s, serial, pair);
            return edge_variance_px2(edge_profile(pair.left, 40));
        };
        // Equal parts of a box: variance w^2 / 12 less that inside one part.
        const double expected_px2 =
            way_px * way_px / 12.0 * (1.0 - 1.0 / (1.0 * kSamples * kSamples));
        // Each instant's edge is rounded to a pixel, by 0.29 px rms: three standard deviations of
        // what that changes in the variance.
        const double rounding_px2 =
            3.0 * 2.0 * std::sqrt(expected_px2) * 0.29 / std::sqrt(kSamples);
        EXPECT_NEAR(variance_px2(kSamples) - variance_px2(0), expected_px2, rounding_px2) << way_px;
        EXPECT_LT(variance_px2(1), 0.3);
    }
}

TEST(ShutterTest, ARollingShutterShearsAnUprightEdge) {
    const Scene scene = plate_scene();
    constexpr double kReadout_s = 0.03;
    constexpr double kSpeed_m_s = 4.0;
    camera::StereoRig rig = level_rig();
    rig.readout_s = kReadout_s;
    // A camera that goes left sees the plate's edge go right.
    const test::Steady sideways({}, {0.0, kSpeed_m_s, 0.0}, Vector3d::Zero());
    Serial serial;
    CleanPair pair;
    const Renderer renderer = Renderer::make(scene, rig, test::noiseless(), 1).value();
    renderer.collect(sideways, 0.0, 0.0, serial, pair);
    const double speed_px_s = kSpeed_m_s * kFocal_px / kWall_m;
    for (int row = 0; row < 94; ++row) {
        // The optical axis meets the edge; pixel centres are whole numbers, the border is at -0.5.
        const double expected_px =
            83.5 + 0.5 + speed_px_s * kReadout_s * ((row + 0.5) / 94.0 - 0.5);
        EXPECT_NEAR(edge_px(edge_profile(pair.left, row)), expected_px, 0.26) << "row " << row;
    }
    CameraConfig global = test::noiseless();
    global.shutter.rolling = false;
    Renderer::make(scene, rig, global, 1).value().collect(sideways, 0.0, 0.0, serial, pair);
    EXPECT_EQ(edge_px(edge_profile(pair.left, 0)), edge_px(edge_profile(pair.left, 93)));
}

TEST(ShutterTest, DepthIsThatOfTheMiddleOfEachRowsExposure) {
    const Scene scene = plate_scene();
    camera::StereoRig rig = level_rig();
    rig.readout_s = 0.05;
    CameraConfig config = test::noiseless();
    config.shutter.blur_samples = 4;
    const test::Steady ahead({}, {1.0, 0.0, 0.0}, Vector3d::Zero());
    Serial serial;
    CleanPair pair;
    Renderer::make(scene, rig, config, 1).value().collect(ahead, 0.2, 0.01, serial, pair);
    for (int row = 0; row < 94; row += 7) {
        const double expected_m = kWall_m - 0.2 - 0.05 * ((row + 0.5) / 94.0 - 0.5);
        EXPECT_NEAR(static_cast<double>(pair.left.depth_m.at(20, row)), expected_m, 1e-6);
        EXPECT_NEAR(static_cast<double>(pair.right.depth_m.at(20, row)), expected_m, 1e-6);
    }
}

/// Away from edges a blurred image is the mean of sharp images at its instants; the shortcut of
/// re-shading on known planes must not change the image.
TEST(ShutterTest, BlurIsTheMeanOfItsInstants) {
    const Scene scene = make_scene("demo_stairs", 1).value().scene;
    CameraConfig config = test::noiseless();
    config.shutter.blur_samples = 3;
    const camera::StereoRig rig = test::small_rig();
    const Renderer renderer = Renderer::make(scene, rig, config, 1).value();
    const test::Steady motion({Eigen::Quaterniond::Identity(), {0.9, 0.0, kBodyHeight_m}},
                              {0.4, 0.1, 0.05},
                              {0.3, 0.4, 0.9});
    constexpr double kExposure_s = 0.02;
    Serial serial;
    CleanPair pair;
    renderer.collect(motion, 0.0, kExposure_s, serial, pair);
    std::vector<CleanImage> instants;
    for (const double offset_s : blur_offsets_s(kExposure_s, 3)) {
        const Pose T_world_left = motion.at(offset_s).T_world_body * rig.body_from_left();
        renderer.render_clean(renderer.left_rays(), T_world_left, serial, instants.emplace_back());
    }
    int compared = 0;
    double moved_dn = 0.0;
    for (int v = 1; v < 93; ++v) {
        for (int u = 1; u < 167; ++u) {
            bool inside = true;
            float mean_dn = 0.0F;
            for (const CleanImage& instant : instants) {
                mean_dn += instant.signal_dn.at(u, v) / 3.0F;
                for (int k = 0; k < 9; ++k) {
                    inside = inside && instant.key.at(u - 1 + k % 3, v - 1 + k / 3) ==
                                           instants[0].key.at(u, v);
                }
            }
            if (!inside) continue;
            EXPECT_NEAR(pair.left.signal_dn.at(u, v), mean_dn, 0.02F) << u << " " << v;
            moved_dn += std::abs(static_cast<double>(mean_dn - instants[1].signal_dn.at(u, v)));
            ++compared;
        }
    }
    EXPECT_GT(compared, 10'000);
    EXPECT_GT(moved_dn / compared, 1.0) << "the camera does not move enough for this test";
}

TEST(ShutterTest, SameBytesForAnyExecutor) {
    Scene scene = make_scene("demo_stairs", 1).value().scene;
    Lighting sun;
    sun.shadows = true;
    sun.stripe_width_m = 0.05;
    scene.light(sun);
    camera::StereoRig rig = test::small_rig();
    rig.readout_s = 0.02;
    CameraConfig config;
    config.shutter.blur_samples = 4;
    config.optics.smear_sigma_px = 0.6;
    config.optics.smudge_sigma_px = 4.0;
    const Renderer renderer = Renderer::make(scene, rig, config, 4).value();
    const test::Steady motion({Eigen::Quaterniond::Identity(), {0.9, 0.0, kBodyHeight_m}},
                              {0.4, 0.1, 0.0},
                              {0.0, 0.2, 0.5});
    const auto render = [&](Executor& executor) {
        CleanPair clean;
        RenderedPair pair;
        renderer.collect(motion, 0.1, 0.01, executor, clean);
        renderer.expose(clean, Shot{}, 3, executor, pair);
        return pair;
    };
    Serial serial;
    const RenderedPair reference = render(serial);
    Backwards backwards;
    Threads two(2);
    Threads three(3);
    for (Executor* executor : {static_cast<Executor*>(&backwards),
                               static_cast<Executor*>(&two),
                               static_cast<Executor*>(&three)}) {
        const RenderedPair other = render(*executor);
        EXPECT_EQ(reference.left, other.left);
        EXPECT_EQ(reference.right, other.right);
    }
}

}  // namespace
}  // namespace surefoot::sim
