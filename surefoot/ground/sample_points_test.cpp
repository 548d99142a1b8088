// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/sample_points.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/ground/ground_observation.hpp"

namespace surefoot::ground {
namespace {

constexpr double kCameraHeight_m = 1.0;

/// The camera of the machine: 1 m above the floor (base_link at the floor), 32 deg down.
camera::RectifiedRig tilted_rig() {
    camera::RectifiedRig rig;
    rig.width = 168;
    rig.height = 94;
    rig.fx_px = rig.fy_px = 85.0;
    rig.cx_px = 83.5;
    rig.cy_px = 46.5;
    rig.baseline_m = 0.12;
    const double down_rad = 32.0 * std::numbers::pi / 180.0;
    rig.T_body_camera =
        Pose{exp_so3({0.0, down_rad, 0.0}), {0.0, 0.0, kCameraHeight_m}} * T_body_optical();
    return rig;
}

/// Exact disparity of the floor z = 0; NaN above the horizon.
DepthImage floor_depth(const camera::RectifiedRig& rig) {
    DepthImage depth;
    depth.resize(rig.width, rig.height);
    depth.sigma_px.fill(0.2F);
    depth.outlier_probability.fill(0.05F);
    for (int v = 0; v < rig.height; ++v) {
        for (int u = 0; u < rig.width; ++u) {
            const Eigen::Vector3d ray_camera(
                (u - rig.cx_px) / rig.fx_px, (v - rig.cy_px) / rig.fy_px, 1.0);
            const double fall = (rig.T_body_camera.rotation * ray_camera).z();
            const double z_m = -kCameraHeight_m / fall;
            const bool seen = fall < 0.0 && z_m < 20.0;
            depth.disparity_px.at(u, v) =
                seen ? static_cast<float>(rig.depth_to_disparity_px_m() / z_m) : kNanF;
        }
    }
    return depth;
}

TEST(SamplePoints, FloorPixelsLieOnTheFloorOfTheBody) {
    const camera::RectifiedRig rig = tilted_rig();
    FramePoints seen;
    seen.points_body_m.resize(3);
    sample_points(rig, floor_depth(rig), 4, seen);
    EXPECT_EQ(seen.camera_body_m, rig.T_body_camera.translation_m);
    ASSERT_GT(seen.points_body_m.size(), 500U);
    for (const auto& p : seen.points_body_m) {
        // Float disparities: a relative error of 6e-8 at up to 20 m.
        EXPECT_NEAR(p.z(), 0.0, 5e-6) << p.transpose();
        EXPECT_GT(p.x(), 0.4);
    }
}

TEST(SamplePoints, SigmaIsThatOfTheInverseRangeByTheDisparity) {
    const camera::RectifiedRig rig = tilted_rig();
    const DepthImage depth = floor_depth(rig);
    DepthImage wrong = depth;
    for (std::size_t i = 0; i < wrong.disparity_px.size(); ++i)
        wrong.disparity_px.data()[i] += depth.sigma_px.data()[i];
    FramePoints seen;
    FramePoints off;
    sample_points(rig, depth, 4, seen);
    sample_points(rig, wrong, 4, off);
    ASSERT_EQ(seen.points_body_m.size(), off.points_body_m.size());
    for (std::size_t i = 0; i < seen.points_body_m.size(); ++i) {
        const auto inverse = [](const FramePoints& frame, std::size_t k) {
            return 1.0 / (frame.points_body_m[k] - frame.camera_body_m).norm();
        };
        const double one_sigma = inverse(off, i) - inverse(seen, i);
        EXPECT_NEAR(seen.inverse_range_sigma[i], one_sigma, 1e-5 * one_sigma);
    }
}

TEST(SamplePoints, FeedsTheGroundObservation) {
    const camera::RectifiedRig rig = tilted_rig();
    FramePoints seen;
    sample_points(rig, floor_depth(rig), 2, seen);
    GroundConfig config;
    config.min_height_m = 0.0;  // base_link is on the floor
    const auto ground = observe_ground(config, seen, Eigen::Vector3d::UnitZ(), 1).observation;
    ASSERT_TRUE(ground.accepted);
    EXPECT_NEAR(ground.height_m, 0.0, 1e-5) << "of base_link";
    EXPECT_NEAR(ground.normal.z(), 1.0, 1e-9);
}

TEST(SamplePoints, MatchingNoiseLeavesTheGroundAccurate) {
    // 0.06 px at this quarter of 672x376 is 0.25 px at full size: 5 mm of height at 1 m, 25 mm at 4
    // m.
    const camera::RectifiedRig rig = tilted_rig();
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        DepthImage depth = floor_depth(rig);
        Rng rng(seed);
        for (std::size_t i = 0; i < depth.disparity_px.size(); ++i) {
            depth.disparity_px.data()[i] += static_cast<float>(0.06 * rng.normal());
        }
        FramePoints seen;
        sample_points(rig, depth, 1, seen);
        const auto ground = observe_ground({}, seen, Eigen::Vector3d::UnitZ(), seed).observation;
        ASSERT_TRUE(ground.accepted) << "seed " << seed;
        EXPECT_NEAR(ground.height_m, 0.0, 0.003) << "seed " << seed;
        EXPECT_LE(std::acos(std::min(ground.normal.z(), 1.0)), 0.15 * std::numbers::pi / 180.0)
            << "seed " << seed;
    }
}

TEST(SamplePoints, UnknownUnlikelyAndImpossiblePixelsAreLeftOut) {
    const camera::RectifiedRig rig = tilted_rig();
    DepthImage depth;
    depth.resize(9, 1);
    depth.disparity_px.fill(10.0F);
    depth.sigma_px.fill(0.2F);
    depth.outlier_probability.fill(0.0F);
    depth.disparity_px.at(0, 0) = kNanF;
    depth.disparity_px.at(1, 0) = 0.0F;
    depth.disparity_px.at(2, 0) = std::numeric_limits<float>::infinity();
    depth.outlier_probability.at(3, 0) = 0.9F;
    depth.outlier_probability.at(4, 0) = kNanF;
    depth.sigma_px.at(5, 0) = kNanF;
    depth.sigma_px.at(6, 0) = 0.0F;
    depth.sigma_px.at(7, 0) = std::numeric_limits<float>::infinity();
    FramePoints seen;
    sample_points(rig, depth, 1, seen);
    EXPECT_EQ(seen.points_body_m.size(), 1U);
    EXPECT_EQ(seen.inverse_range_sigma.size(), 1U);
    sample_points(rig, depth, 1, seen, 1.0F);
    EXPECT_EQ(seen.points_body_m.size(), 2U);
    sample_points(rig, DepthImage{}, 1, seen);
    EXPECT_TRUE(seen.points_body_m.empty());
    EXPECT_TRUE(seen.inverse_range_sigma.empty());
}

}  // namespace
}  // namespace surefoot::ground
