// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/analytic_stereo.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/sim/rendering/renderer.hpp"
#include "surefoot/sim/sensors/rigs.hpp"
#include "surefoot/sim/sensors/sensor_scenes_testing.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

AnalyticStereoConfig errorless() {
    AnalyticStereoConfig config;
    config.sigma_px = 0.0;
    config.locking_px = 0.0;
    config.shadow.fattening_px = 0.0;
    config.invented_share = 0.0;
    config.missing_share = 0.0;
    config.fade_incidence_deg = 90.0;
    config.max_incidence_deg = 90.0;
    config.least_contrast = 0.0;
    return config;
}

/// Noise only: everything is matched.
AnalyticStereoConfig noisy(double sigma_px, double correlated_share, double fixed_share) {
    AnalyticStereoConfig config = errorless();
    config.sigma_px = sigma_px;
    config.correlated_share = correlated_share;
    config.fixed_share = fixed_share;
    return config;
}

/// The ZED's small mode: level, at (0, 0, 1), or as it is mounted.
camera::RectifiedRig level_rig() {
    return {672, 376, 342.0, 342.0, 335.5, 187.5, 0.12, T_body_optical()};
}
camera::RectifiedRig mounted_rig() {
    return camera::Rectifier::make(rig_preset("zed_vga").value()).value().rig();
}

Pose body_at_height(double height_m) {
    Pose T_world_body;
    T_world_body.translation_m = {0.0, 0.0, height_m};
    return T_world_body;
}

DepthImage measured(const Scene& scene,
                    const camera::RectifiedRig& rig,
                    const AnalyticStereoConfig& config,
                    double height_m = 1.0,
                    int frame = 0) {
    Serial serial;
    AnalyticStereo::View view;
    DepthImage out;
    AnalyticStereo::make(scene, rig, config, 11)
        .value()
        .measure(body_at_height(height_m), frame, serial, view, out);
    return out;
}

Image<float> exact(const Scene& scene, const camera::RectifiedRig& rig, double height_m = 1.0) {
    Serial serial;
    return rectified_disparity_px(scene, rig, body_at_height(height_m), serial);
}

/// Whether the right camera sees the point that the left camera sees in a pixel; uses rays.
bool right_camera_sees(const Scene& scene,
                       const camera::RectifiedRig& rig,
                       const Pose& T_world_body,
                       const Vector3d& p_left_m) {
    const Pose T_world_left = T_world_body * rig.T_body_camera;
    const Vector3d right_m = T_world_left * Vector3d(rig.baseline_m, 0.0, 0.0);
    const Vector3d to_point = T_world_left * p_left_m - right_m;
    const double distance_m = to_point.norm();
    return !scene.blocked(right_m, to_point / distance_m, distance_m - 1e-4);
}

TEST(AnalyticStereoTest, WithoutErrorsItIsTheExactDisparityWhereBothEyesSee) {
    const Scene scene = test::scene_with_box();
    const camera::RectifiedRig rig = mounted_rig();
    const Image<float> truth_px = exact(scene, rig, kBodyHeight_m);
    const DepthImage depth = measured(scene, rig, errorless(), kBodyHeight_m);
    int known = 0;
    int disagree = 0;
    for (int v = 0; v < rig.height; ++v) {
        for (int u = 0; u < rig.width; ++u) {
            const float truth = truth_px.row(v)[u];
            const float measured_px = depth.disparity_px.row(v)[u];
            if (std::isnan(truth)) {
                EXPECT_TRUE(std::isnan(measured_px));
                continue;
            }
            const auto d = static_cast<double>(truth);
            const bool seen =
                u - d >= -0.5 &&
                right_camera_sees(scene, rig, body_at_height(kBodyHeight_m), rig.point(u, v, d));
            disagree += seen == std::isnan(measured_px) ? 1 : 0;
            if (std::isnan(measured_px)) {
                EXPECT_EQ(depth.outlier_probability.row(v)[u], 1.0F);
                EXPECT_TRUE(std::isnan(depth.sigma_px.row(v)[u]));
                continue;
            }
            EXPECT_EQ(measured_px, truth);
            ++known;
        }
    }
    EXPECT_GT(known, 200000);
    // Rows of pixels against rays: less than one pixel at the border of the shadow in each of the
    // rows of the box.
    EXPECT_LT(disagree, 60);
}

TEST(AnalyticStereoTest, StrideGivesTheSamePixelsInUnitsOfItsOwn) {
    const Scene scene = test::scene_with_box();
    const camera::RectifiedRig full = mounted_rig();
    AnalyticStereoConfig config = errorless();
    config.stride = 4;
    const AnalyticStereo stereo = AnalyticStereo::make(scene, full, config, 1).value();
    EXPECT_EQ(stereo.rig().width, 168);
    EXPECT_EQ(stereo.rig().height, 94);
    const Image<float> truth_px = exact(scene, full, kBodyHeight_m);
    Serial serial;
    DepthImage depth;
    AnalyticStereo::View view;
    stereo.measure(body_at_height(kBodyHeight_m), 0, serial, view, depth);
    int known = 0;
    for (int v = 0; v < 94; ++v) {
        for (int u = 0; u < 168; ++u) {
            const auto thin_px = static_cast<double>(depth.disparity_px.at(u, v));
            if (std::isnan(thin_px)) continue;
            const auto full_px = static_cast<double>(truth_px.at(4 * u + 2, 4 * v + 2));
            EXPECT_NEAR(4.0 * thin_px, full_px, 1e-6 * full_px);
            // Both cameras see the same point in space.
            const Vector3d p_m = stereo.rig().point(u, v, thin_px);
            EXPECT_LT((p_m - full.point(4 * u + 2, 4 * v + 2, full_px)).norm(), 1e-5 * p_m.norm());
            ++known;
        }
    }
    EXPECT_GT(known, 168 * 94 * 8 / 10);
}

/// Errors of a wall 2 m away over some frames.
struct Errors {
    double variance_px2 = 0.0;
    double lag_px2 = 0.0;     ///< product of neighbours `correlation_px` apart
    double frames_px2 = 0.0;  ///< product of a pixel in two frames
    double white_px2 = 0.0;   ///< half the squared difference of neighbours
};
Errors wall_errors(const AnalyticStereoConfig& config, int frames) {
    const Scene scene = test::wall_ahead(2.0);
    const camera::RectifiedRig rig = level_rig();
    const auto truth = static_cast<float>(342.0 * 0.12 / 2.0);
    const int lag = static_cast<int>(config.correlation_px) / config.stride;
    Errors errors;
    double count = 0.0;
    Image<float> before;
    const auto error = [&](const Image<float>& image, int u, int v) {
        return static_cast<double>(image.at(u, v) - truth / static_cast<float>(config.stride)) *
               config.stride;
    };
    for (int frame = 0; frame < frames; ++frame) {
        const DepthImage depth = measured(scene, rig, config, 1.0, frame);
        const Image<float>& now = depth.disparity_px;
        if (frame > 0) {
            for (int v = 0; v < now.height(); v += 3) {
                for (int u = 24; u + lag < now.width(); u += 3) {
                    const double here = error(now, u, v);
                    errors.variance_px2 += here * here;
                    errors.lag_px2 += here * error(now, u + lag, v);
                    errors.frames_px2 += here * error(before, u, v);
                    const double step = here - error(now, u + 1, v);
                    errors.white_px2 += 0.5 * step * step;
                    count += 1.0;
                }
            }
        }
        before = now;
    }
    errors.variance_px2 /= count;
    errors.lag_px2 /= count;
    errors.frames_px2 /= count;
    errors.white_px2 /= count;
    return errors;
}

TEST(AnalyticStereoTest, NoiseHasItsSigmaItsWhiteShareAndItsCorrelation) {
    const double variance_px2 = 0.25 * 0.25;
    const Errors errors = wall_errors(noisy(0.25, 0.6, 0.0), 25);
    EXPECT_NEAR(std::sqrt(errors.variance_px2) / 0.25, 1.0, 0.03);
    // At the correlation length 1/e of the smooth part is left.
    EXPECT_NEAR(errors.lag_px2 / variance_px2, 0.6 / std::numbers::e, 0.03);
    // Neighbours share the smooth part but for (1 px / 15 px)^2.
    EXPECT_NEAR(errors.white_px2 / variance_px2, 0.4, 0.01);
    EXPECT_NEAR(errors.frames_px2 / variance_px2, 0.0, 0.02);
}

TEST(AnalyticStereoTest, TheFixedShareStaysFromFrameToFrame) {
    const double variance_px2 = 0.25 * 0.25;
    const Errors errors = wall_errors(noisy(0.25, 0.8, 0.5), 25);
    EXPECT_NEAR(std::sqrt(errors.variance_px2) / 0.25, 1.0, 0.05);
    // The surface's own pattern is one sample of some 600 cells of 90 mm.
    EXPECT_NEAR(errors.frames_px2 / variance_px2, 0.4, 0.08);
    AnalyticStereoConfig thin = noisy(0.25, 0.8, 0.0);
    thin.stride = 3;
    EXPECT_NEAR(std::sqrt(wall_errors(thin, 40).variance_px2) / 0.25, 1.0, 0.03);
}

TEST(AnalyticStereoTest, ReportedSigmaIsHonestUnlessToldOtherwise) {
    AnalyticStereoConfig config = noisy(0.25, 0.5, 0.3);
    config.locking_px = 0.3;
    const Scene scene = test::floor_only();
    const camera::RectifiedRig rig = mounted_rig();
    const Image<float> truth_px = exact(scene, rig, kBodyHeight_m);
    const auto normalised = [&](int frame) {
        const DepthImage depth = measured(scene, rig, config, kBodyHeight_m, frame);
        double squares = 0.0;
        double count = 0.0;
        for (std::size_t i = 0; i < truth_px.size(); ++i) {
            const auto error =
                static_cast<double>(depth.disparity_px.data()[i] - truth_px.data()[i]);
            if (std::isnan(error)) continue;
            const auto sigma = static_cast<double>(depth.sigma_px.data()[i]);
            squares += error * error / (sigma * sigma);
            count += 1.0;
        }
        return std::sqrt(squares / count);
    };
    double mean = 0.0;
    for (int frame = 0; frame < 10; ++frame) mean += 0.1 * normalised(frame);
    EXPECT_NEAR(mean, 1.0, 0.05);
    config.sigma_factor = 0.5;
    EXPECT_NEAR(normalised(0), 2.0, 0.15);
}

TEST(AnalyticStereoTest, LockingIsASineOfTheFraction) {
    AnalyticStereoConfig config = errorless();
    config.locking_px = 0.1;
    const Scene scene = test::floor_only();
    const camera::RectifiedRig rig = mounted_rig();
    const Image<float> truth_px = exact(scene, rig, kBodyHeight_m);
    const DepthImage depth = measured(scene, rig, config, kBodyHeight_m);
    for (int v = 0; v < rig.height; v += 7) {
        const auto d = static_cast<double>(truth_px.at(400, v));
        const auto error = static_cast<double>(depth.disparity_px.at(400, v)) - d;
        EXPECT_NEAR(error, 0.1 * std::sin(2.0 * std::numbers::pi * d), 1e-4) << v;
    }
}

/// Left of a plate lies a strip that the right camera cannot see; its width is f b (1/z_plate -
/// 1/z_wall).
TEST(AnalyticStereoTest, OccludedStripIsAsWideAsGeometrySaysAndBridgedAsOftenAsAsked) {
    const Scene scene = test::plate_before_wall(1.0, 2.0, 0.5);
    const double width_px = 342.0 * 0.12 * (1.0 - 0.5);  // 20.5
    const camera::RectifiedRig rig = level_rig();
    const DepthImage none = measured(scene, rig, errorless());
    int first = 0;
    while (!(none.disparity_px.at(first, 187) > 30.0F)) ++first;
    int unknown = 0;
    while (std::isnan(none.disparity_px.at(first - 1 - unknown, 187))) ++unknown;
    EXPECT_NEAR(unknown, width_px, 1.0);
    int last = first;
    while (none.disparity_px.at(last, 187) > 30.0F) ++last;
    EXPECT_FALSE(std::isnan(none.disparity_px.at(last, 187))) << "no shadow on the right";

    // Bridged all: a straight ramp from wall (20.5 px) to plate (41 px).
    AnalyticStereoConfig config = errorless();
    config.invented_share = 1.0;
    const DepthImage all = measured(scene, rig, config);
    for (int i = 1; i <= unknown; ++i) {
        const double share = static_cast<double>(i) / (unknown + 1);
        EXPECT_NEAR(
            static_cast<double>(all.disparity_px.at(first - i, 187)), 41.04 - share * 20.52, 1e-3);
        EXPECT_EQ(all.outlier_probability.at(first - i, 187),
                  static_cast<float>(config.edge_suspicion));
    }
    // Bridged a third, in patches: mean over frames.
    config.invented_share = 1.0 / 3.0;
    double bridged = 0.0;
    double strip = 0.0;
    for (int frame = 0; frame < 8; ++frame) {
        const DepthImage some = measured(scene, rig, config, 1.0, frame);
        for (int v = 0; v < rig.height; ++v) {
            if (std::isnan(all.disparity_px.at(first - 1, v))) continue;
            for (int i = 1; i <= unknown; ++i) {
                bridged += std::isnan(some.disparity_px.at(first - i, v)) ? 0.0 : 1.0;
                strip += 1.0;
            }
        }
    }
    EXPECT_NEAR(bridged / strip, 1.0 / 3.0, 0.05);
}

/// Behind a drop edge ahead the lower floor begins with a jump; seam and ramp lie above it in the
/// image, and in space between the edge and the floor that is seen, over the hidden ground.
TEST(AnalyticStereoTest, RampsAreInventedBehindADropEdge) {
    const Scene scene = test::drop_ahead(1.5, 0.15);
    const camera::RectifiedRig rig = mounted_rig();
    const Image<float> truth_px = exact(scene, rig, kBodyHeight_m);
    AnalyticStereoConfig config = errorless();
    config.shadow.fattening_px = 2.0;
    config.shadow.ramp_px = 8.0;
    config.invented_share = 1.0;
    const DepthImage depth = measured(scene, rig, config, kBodyHeight_m);
    int edge = 0;  // first row that shows the upper floor
    constexpr int kColumn = 400;
    while (truth_px.at(kColumn, edge + 1) - truth_px.at(kColumn, edge) < 0.7F) ++edge;
    const Pose T_world_camera = body_at_height(kBodyHeight_m) * rig.T_body_camera;
    const auto world = [&](int v) {
        return T_world_camera *
               rig.point(kColumn, v, static_cast<double>(depth.disparity_px.at(kColumn, v)));
    };
    const float front_px = truth_px.at(kColumn, edge + 1);
    EXPECT_EQ(depth.disparity_px.at(kColumn, edge), front_px);
    EXPECT_EQ(depth.disparity_px.at(kColumn, edge - 1), front_px);
    for (int v = edge - 7; v <= edge - 2; ++v) {
        EXPECT_LT(depth.disparity_px.at(kColumn, v), front_px) << v;
        EXPECT_GT(depth.disparity_px.at(kColumn, v), truth_px.at(kColumn, v)) << v;
        EXPECT_GT(world(v).x(), 1.5 - 0.01);
        EXPECT_GT(world(v).z(), -0.15);
        EXPECT_LT(world(v).z(), 0.05);
    }
    EXPECT_EQ(depth.disparity_px.at(kColumn, edge - 8), truth_px.at(kColumn, edge - 8));
    EXPECT_EQ(depth.disparity_px.at(kColumn, edge + 1), front_px) << "the upper floor is right";
    EXPECT_EQ(depth.outlier_probability.at(kColumn, edge + 2),
              static_cast<float>(config.plain_suspicion));
}

TEST(AnalyticStereoTest, MissingSharesAreThoseOfTheModel) {
    const auto known = [](const Scene& scene, const AnalyticStereoConfig& config) {
        double count = 0.0;
        double all = 0.0;
        for (int frame = 0; frame < 4; ++frame) {
            const DepthImage depth = measured(scene, level_rig(), config, 1.0, frame);
            for (int v = 0; v < 376; ++v) {
                for (int u = 30; u < 672; ++u) {  // the right camera sees them
                    count += std::isnan(depth.disparity_px.at(u, v)) ? 0.0 : 1.0;
                    all += 1.0;
                }
            }
        }
        return count / all;
    };
    AnalyticStereoConfig config = errorless();
    EXPECT_EQ(known(test::wall_ahead(2.0), config), 1.0);
    config.missing_share = 0.1;
    EXPECT_NEAR(known(test::wall_ahead(2.0), config), 0.9, 0.01);
    config = errorless();
    config.least_contrast = 0.2;
    Material plain;
    plain.contrast = 0.05;
    EXPECT_NEAR(known(test::wall_ahead(2.0, plain), config), 0.25, 0.015);
    plain.contrast = 0.0;
    EXPECT_EQ(known(test::wall_ahead(2.0, plain), config), 0.0);
    Material mirror;
    mirror.finish = Finish::mirror;
    EXPECT_EQ(known(test::wall_ahead(2.0, mirror), errorless()), 0.0);
    config = errorless();
    config.max_disparity_px = 20.0;  // nearer than 2.05 m
    EXPECT_EQ(known(test::wall_ahead(2.0), config), 0.0);
}

/// A floor 1 m below a level camera is seen at atan(z / 1 m): lost from 80 deg on, faded from 70.
TEST(AnalyticStereoTest, GrazingFloorIsLost) {
    AnalyticStereoConfig config = errorless();
    config.fade_incidence_deg = 70.0;
    config.max_incidence_deg = 80.0;
    const DepthImage depth = measured(test::floor_only(), level_rig(), config);
    const auto known_in_row = [&](double incidence_deg) {
        const double z_m = std::tan(incidence_deg * std::numbers::pi / 180.0);
        const int v = static_cast<int>(std::lround(187.5 + 342.0 / z_m));
        // Near the middle column, where incidence is that of the row.
        int known = 0;
        for (int u = 316; u < 356; ++u) known += std::isnan(depth.disparity_px.at(u, v)) ? 0 : 1;
        return known;
    };
    EXPECT_EQ(known_in_row(80.5), 0);
    EXPECT_EQ(known_in_row(69.0), 40);
}

TEST(AnalyticStereoTest, SameBytesForAnyExecutorAndOtherNoiseInAnotherFrame) {
    const Scene scene = test::scene_with_box();
    const AnalyticStereo stereo =
        AnalyticStereo::make(scene, mounted_rig(), AnalyticStereoConfig{}, 3).value();
    Serial serial;
    Backwards backwards;
    Threads threads(3);
    DepthImage a;
    DepthImage b;
    DepthImage c;
    DepthImage d;
    AnalyticStereo::View view;  // reused: old contents must not appear
    stereo.measure(body_at_height(2.0), 1, serial, view, a);
    stereo.measure(body_at_height(kBodyHeight_m), 5, serial, view, a);
    stereo.measure(body_at_height(kBodyHeight_m), 5, backwards, view, b);
    stereo.measure(body_at_height(kBodyHeight_m), 5, threads, view, c);
    stereo.measure(body_at_height(kBodyHeight_m), 6, serial, view, d);
    EXPECT_TRUE(test::same_bytes(a.disparity_px, b.disparity_px));
    EXPECT_TRUE(test::same_bytes(a.disparity_px, c.disparity_px));
    EXPECT_TRUE(test::same_bytes(a.outlier_probability, c.outlier_probability));
    EXPECT_FALSE(test::same_bytes(a.disparity_px, d.disparity_px));
}

TEST(AnalyticStereoTest, WhatCannotBeIsRefusedInWords) {
    const Scene scene = test::floor_only();
    AnalyticStereoConfig config;
    config.stride = 0;
    const auto stride = AnalyticStereo::make(scene, level_rig(), config, 1);
    ASSERT_FALSE(stride);
    EXPECT_EQ(stride.error().message,
              "simulator: analytic stereo: stride = 0 must be between 1 and the 376 px of the "
              "shorter image side");
    config = AnalyticStereoConfig{};
    config.fixed_share = 1.5;
    const auto share = AnalyticStereo::make(scene, level_rig(), config, 1);
    ASSERT_FALSE(share);
    EXPECT_NE(share.error().message.find("fixed_share = 1.5"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::sim
