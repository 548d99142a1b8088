// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/renderer.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/sim/rendering/ray_caster.hpp"
#include "surefoot/sim/scenes/scenes.hpp"
#include "surefoot/sim/sensors/cameras_testing.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

camera::StereoRig zed() {
    return rig_preset("zed_vga").value();
}

/// A fisheye camera on the left and a distorted pinhole camera on the right, rotated against each
/// other by some degrees.
camera::StereoRig odd_rig() {
    camera::KannalaBrandt fisheye;
    fisheye.fx_px = 180.0;
    fisheye.fy_px = 182.0;
    fisheye.cx_px = 201.3;
    fisheye.cy_px = 148.7;
    fisheye.k1 = -0.02;
    fisheye.k2 = 0.004;
    camera::PinholeRadTan distorted;
    distorted.fx_px = 230.0;
    distorted.fy_px = 229.0;
    distorted.cx_px = 197.0;
    distorted.cy_px = 152.0;
    distorted.k1 = -0.28;
    distorted.k2 = 0.07;
    distorted.p1 = 2e-4;
    camera::StereoRig rig = zed();
    rig.name = "odd";
    rig.rectified = false;
    rig.left = {fisheye, 400, 300};
    rig.right = camera::Camera{distorted, 400, 300};
    rig.T_left_right.rotation = exp_so3({0.02, -0.03, 0.015});
    rig.T_left_right.translation_m = {0.11, 0.002, -0.001};
    return rig;
}

Pose body_at(double x_m) {
    Pose T;
    T.translation_m = {x_m, 0.0, kBodyHeight_m};
    return T;
}

float bilinear(const Image<float>& image, const Vector2d& pixel) {
    const int u = static_cast<int>(pixel.x());
    const int v = static_cast<int>(pixel.y());
    const auto fu = static_cast<float>(pixel.x() - u);
    const auto fv = static_cast<float>(pixel.y() - v);
    const float low = image.at(u, v) + fu * (image.at(u + 1, v) - image.at(u, v));
    const float high = image.at(u, v + 1) + fu * (image.at(u + 1, v + 1) - image.at(u, v + 1));
    return low + fv * (high - low);
}

TEST(RendererTest, DepthOfTheFloorFollowsThePlaneEquation) {
    const Scene scene = make_scene("floor", 1).value().scene;
    for (const camera::StereoRig& rig : {zed(), odd_rig()}) {
        const Renderer renderer = Renderer::make(scene, rig, test::noiseless(), 1).value();
        Serial serial;
        CleanImage image;
        const Pose T_world_left = body_at(0.0) * *rig.T_body_left;
        renderer.render_clean(renderer.left_rays(), T_world_left, serial, image);
        int floor_pixels = 0;
        for (int v = 0; v < rig.left.height; v += 3) {
            for (int u = 0; u < rig.left.width; u += 3) {
                const auto ray = camera::unproject(rig.left.model, {u, v});
                if (!ray || image.surface.at(u, v) != 0) continue;
                const Vector3d direction = T_world_left.rotation * *ray;
                const double depth_m = -T_world_left.translation_m.z() / direction.z() * ray->z();
                EXPECT_NEAR(static_cast<double>(image.depth_m.at(u, v)), depth_m, 1e-6 * depth_m)
                    << rig.name << " " << u << " " << v;
                ++floor_pixels;
            }
        }
        EXPECT_GT(floor_pixels, 8000) << rig.name;
    }
}

/// Compares casting block by block, with the proofs of the cones, with casting every ray against
/// every primitive: same face and same distance, to the last bit.
TEST(RendererTest, WhatABlockProvesChangesNoHit) {
    Rng rng(5);
    int proved = 0;
    for (const char* name : {"demo_stairs", "room", "stairs_up_ada", "flight_20_up", "spiral_up"}) {
        const Scene scene = make_scene(name, 2).value().scene;
        for (const camera::StereoRig& rig : {zed(), odd_rig()}) {
            const RayField rays(rig.left);
            Pose start = body_at(rng.uniform(0.0, 0.9));
            start.rotation = exp_so3({0.0, 0.0, rng.uniform(-0.6, 0.6)});
            // Standing, and with rows exposed while it walks and turns.
            const test::Steady walk(start, {1.0, 0.2, 0.1}, {0.1, 0.2, 0.6});
            const double readout_s = rig.name == "odd" ? 0.02 : 0.0;
            const ImageViews views(walk, *rig.T_body_left, 0.0, readout_s, rig.left.height);
            for (int block_y = 0; block_y < rays.blocks_y(); block_y += 2) {
                for (int block_x = 0; block_x < rays.blocks_x(); ++block_x) {
                    CastBlock block;
                    cast_block(scene, rays, views, block_x, block_y, block);
                    proved += block.plane ? 1 : 0;
                    for (int i = 0; i < block.width * block.height; i += 7) {
                        const auto index = static_cast<std::size_t>(i);
                        const auto hit =
                            scene.intersect(views.row(block.v0 + i / block.width).origin_m,
                                            block.directions[index]);
                        ASSERT_EQ(block.hits[index].face, hit ? hit->surface : -1)
                            << name << " block " << block_x << " " << block_y << " pixel " << i;
                        if (!hit) continue;
                        ASSERT_EQ(block.hits[index].distance_m, hit->distance_m) << name;
                    }
                }
            }
        }
    }
    EXPECT_GT(proved, 1000);
}

/// A wall at a distance whose disparity is a whole number of pixels: both cameras then sample the
/// same points of it, and no interpolation blurs the comparison.
TEST(RendererTest, AWallAtWholeDisparityShiftsByExactlyThat) {
    constexpr int kDisparity_px = 27;
    camera::StereoRig rig = zed();
    rig.T_body_left = looking_down({0.0, 0.0, 0.0}, 0.0);
    const double wall_m = 342.0 * 0.12 / kDisparity_px;
    Scene scene;
    scene.add(
        make_box({wall_m + 0.5, 0.0}, {1.0, 20.0}, -5.0, 5.0), scene.add_material({}), Label::wall);
    const Renderer renderer = Renderer::make(scene, rig, test::noiseless(), 1).value();
    Serial serial;
    CleanImage left;
    CleanImage right;
    const Pose T_world_left = *rig.T_body_left;
    renderer.render_clean(renderer.left_rays(), T_world_left, serial, left);
    renderer.render_clean(renderer.right_rays(), T_world_left * rig.T_left_right, serial, right);
    double error2 = 0.0;
    int pixels = 0;
    for (int v = 0; v < rig.left.height; v += 5) {
        for (int u = kDisparity_px; u < rig.left.width; ++u) {
            EXPECT_NEAR(static_cast<double>(left.depth_m.at(u, v)), wall_m, 1e-6);
            const float error = left.signal_dn.at(u, v) - right.signal_dn.at(u - kDisparity_px, v);
            error2 += static_cast<double>(error * error);
            ++pixels;
        }
    }
    // The remaining differences: pixels at different obliqueness average over different areas.
    EXPECT_LT(std::sqrt(error2 / pixels), 0.7);
}

struct Warp {
    double rms_dn = 0.0;      ///< left image against the right one, fetched through exact depth
    double off_rms_dn = 0.0;  ///< rms of values fetched one pixel beside
    int pixels = 0;
};

Warp warp(const camera::StereoRig& rig, const CleanImage& left, const CleanImage& right) {
    Warp result;
    for (int v = 4; v < rig.left.height - 4; ++v) {
        for (int u = 4; u < rig.left.width - 4; ++u) {
            const auto ray = camera::unproject(rig.left.model, {u, v});
            const float depth_m = left.depth_m.at(u, v);
            if (!ray || !(ray->z() > 0.1) || !std::isfinite(depth_m)) continue;
            const Vector3d p_left = *ray * (static_cast<double>(depth_m) / ray->z());
            const Vector3d p_right = rig.T_left_right.inverse() * p_left;
            const auto pixel = camera::project(rig.right->model, p_right);
            if (!pixel || pixel->x() < 3.0 || pixel->y() < 3.0 ||
                pixel->x() > rig.right->width - 5.0 || pixel->y() > rig.right->height - 5.0) {
                continue;
            }
            const int u_right = static_cast<int>(std::lround(pixel->x()));
            const int v_right = static_cast<int>(std::lround(pixel->y()));
            // Only where both see the same face, away from edges.
            const std::int16_t face = left.surface.at(u, v);
            bool same = true;
            for (int dv = -2; dv <= 2; ++dv) {
                for (int du = -2; du <= 2; ++du) {
                    same = same && left.surface.at(u + du, v + dv) == face &&
                           right.surface.at(u_right + du, v_right + dv) == face;
                }
            }
            if (!same) continue;
            const double here = static_cast<double>(left.signal_dn.at(u, v));
            const double there = static_cast<double>(bilinear(right.signal_dn, *pixel));
            const double beside =
                static_cast<double>(bilinear(right.signal_dn, *pixel + Vector2d(1.0, 0.0)));
            result.rms_dn += (here - there) * (here - there);
            result.off_rms_dn += (here - beside) * (here - beside);
            ++result.pixels;
        }
    }
    result.rms_dn = std::sqrt(result.rms_dn / result.pixels);
    result.off_rms_dn = std::sqrt(result.off_rms_dn / result.pixels);
    return result;
}

TEST(RendererTest, ExactDepthWarpsTheRightImageOntoTheLeft) {
    const Scene scene = make_scene("demo_stairs", 1).value().scene;
    for (const camera::StereoRig& rig : {zed(), odd_rig()}) {
        const Renderer renderer = Renderer::make(scene, rig, test::noiseless(), 1).value();
        Serial serial;
        CleanImage left;
        CleanImage right;
        const Pose T_world_left = body_at(0.9) * *rig.T_body_left;
        renderer.render_clean(renderer.left_rays(), T_world_left, serial, left);
        renderer.render_clean(
            renderer.right_rays(), T_world_left * rig.T_left_right, serial, right);
        const Warp result = warp(rig, left, right);
        EXPECT_GT(result.pixels, rig.left.width * rig.left.height / 3) << rig.name;
        // Linear interpolation between pixels costs a few grey values in textures this sharp.
        EXPECT_LT(result.rms_dn, 0.45 * result.off_rms_dn) << rig.name;
        EXPECT_LT(result.rms_dn, 5.0) << rig.name;
        std::printf("warp %s: %.2f dn, one pixel off %.2f dn, %d pixels\n",
                    rig.name.c_str(),
                    result.rms_dn,
                    result.off_rms_dn,
                    result.pixels);
    }
}

TEST(RendererTest, SameBytesForAnyExecutor) {
    const Scene scene = make_scene("demo_stairs", 1).value().scene;
    const Renderer renderer = Renderer::make(scene, odd_rig(), CameraConfig{}, 4).value();
    Serial serial;
    RenderedPair reference;
    renderer.render(body_at(0.5), 3, serial, reference);
    Backwards backwards;
    Threads threads(3);
    for (Executor* executor :
         {static_cast<Executor*>(&backwards), static_cast<Executor*>(&threads)}) {
        RenderedPair other;
        renderer.render(body_at(0.5), 3, *executor, other);
        EXPECT_EQ(reference.left, other.left);
        EXPECT_EQ(reference.right, other.right);
        for (std::size_t i = 0; i < reference.depth_m.size(); ++i) {
            const float a = reference.depth_m.data()[i];
            const float b = other.depth_m.data()[i];
            ASSERT_TRUE(a == b || (std::isnan(a) && std::isnan(b)));
        }
    }
}

TEST(RendererTest, ImagesCarryTheConfiguredNoise) {
    const Scene scene = make_scene("floor", 1).value().scene;
    const camera::StereoRig rig = zed();
    CameraConfig config = test::noiseless();
    config.imaging.read_noise_dn = 2.0;
    const Renderer renderer = Renderer::make(scene, rig, config, 1).value();
    Serial serial;
    RenderedPair a;
    RenderedPair b;
    renderer.render(body_at(0.0), 0, serial, a);
    renderer.render(body_at(0.0), 1, serial, b);
    double difference2 = 0.0;
    for (std::size_t i = 0; i < a.left.size(); ++i) {
        const double d = a.left.data()[i] - b.left.data()[i];
        difference2 += d * d;
    }
    const double sigma = std::sqrt(difference2 / static_cast<double>(a.left.size()) / 2.0);
    // Two independent frames: twice the variance, each with rounding 1/12. 0.3 % standard error.
    EXPECT_NEAR(sigma, std::sqrt(4.0 + 1.0 / 12.0), 0.03);
}

TEST(RendererTest, SmoothedNoiseKeepsItsStrengthAndIsSharedByNeighbours) {
    // A wall without texture that fills the view: what varies is the noise.
    Scene scene;
    Material grey;
    grey.contrast = 0.0;
    scene.add(
        make_box({3.0, 0.0}, {0.2, 40.0}, -20.0, 20.0), scene.add_material(grey), Label::wall);
    CameraConfig config = test::noiseless();
    config.imaging.read_noise_dn = 6.0;
    config.imaging.noise_size_px = 1.5;
    const Renderer renderer = Renderer::make(scene, zed(), config, 3).value();
    CameraConfig clean_config = config;
    clean_config.imaging.read_noise_dn = 0.0;
    const Renderer clean = Renderer::make(scene, zed(), clean_config, 3).value();
    Serial serial;
    RenderedPair noisy;
    RenderedPair quiet;
    renderer.render(body_at(0.0), 0, serial, noisy);
    clean.render(body_at(0.0), 0, serial, quiet);
    double square = 0.0;
    double with_next = 0.0;
    double with_far = 0.0;
    int count = 0;
    const auto noise = [&](int u, int v) {
        return static_cast<double>(noisy.left.at(u, v)) - static_cast<double>(quiet.left.at(u, v));
    };
    for (int v = 20; v < 350; ++v) {
        for (int u = 20; u < 600; ++u) {
            square += noise(u, v) * noise(u, v);
            with_next += noise(u, v) * noise(u + 1, v);
            with_far += noise(u, v) * noise(u + 12, v);
            ++count;
        }
    }
    EXPECT_NEAR(std::sqrt(square / count), 6.0, 0.2);
    // A Gaussian of sigma s convolved with itself: correlation exp(-1 / (4 s^2)) at distance 1.
    EXPECT_NEAR(with_next / square, std::exp(-1.0 / (4.0 * 1.5 * 1.5)), 0.02);
    EXPECT_NEAR(with_far / square, 0.0, 0.02);
}

TEST(RendererTest, VignettingDarkensCorners) {
    const Scene scene = make_scene("floor", 1).value().scene;
    CameraConfig config = test::noiseless();
    Serial serial;
    RenderedPair even;
    Renderer::make(scene, zed(), config, 1).value().render(body_at(0.0), 0, serial, even);
    config.imaging.vignetting = 0.5;
    RenderedPair dark;
    Renderer::make(scene, zed(), config, 1).value().render(body_at(0.0), 0, serial, dark);
    EXPECT_EQ(even.left.at(336, 188), dark.left.at(336, 188));
    EXPECT_NEAR(dark.left.at(0, 375), 0.5 * even.left.at(0, 375), 1.0);
}

TEST(RendererTest, DisparityIsThatOfTheRectifiedCamera) {
    const Scene scene = make_scene("demo_stairs", 1).value().scene;
    const camera::StereoRig rig = zed();
    const camera::RectifiedRig rectified{
        672, 376, 342.0, 342.0, 335.5, 187.5, 0.12, *rig.T_body_left};
    const Renderer renderer = Renderer::make(scene, rig, test::noiseless(), 1).value();
    Serial serial;
    RenderedPair pair;
    renderer.render(body_at(0.9), 0, serial, pair);
    const Image<float> from_depth = disparity_px(pair.depth_m, rectified);
    const Image<float> direct = rectified_disparity_px(scene, rectified, body_at(0.9), serial);
    for (int v = 0; v < 376; v += 5) {
        for (int u = 0; u < 672; u += 5) {
            const double z_m = static_cast<double>(pair.depth_m.at(u, v));
            EXPECT_NEAR(static_cast<double>(from_depth.at(u, v)), 342.0 * 0.12 / z_m, 1e-4);
            EXPECT_NEAR(from_depth.at(u, v), direct.at(u, v), 1e-4);
        }
    }
}

TEST(RendererTest, RefusesARigWithoutARightCamera) {
    const Scene scene = make_scene("floor", 1).value().scene;
    camera::StereoRig rig = zed();
    rig.right.reset();
    const auto renderer = Renderer::make(scene, rig, CameraConfig{}, 1);
    ASSERT_FALSE(renderer);
    EXPECT_NE(renderer.error().message.find("no right camera"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::sim
