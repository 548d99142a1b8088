// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/sample_points.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "surefoot/core/rng.hpp"
#include "surefoot/ground/ground_observation.hpp"

namespace surefoot::ground {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
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
camera::DepthImage floor_depth(const camera::RectifiedRig& rig) {
    camera::DepthImage depth;
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
                seen ? static_cast<float>(rig.depth_to_disparity_px_m() / z_m) : kNaN;
        }
    }
    return depth;
}

TEST(SamplePoints, FloorPixelsLieOnTheFloorOfTheBody) {
    const camera::RectifiedRig rig = tilted_rig();
    std::vector<Eigen::Vector3d> points(3, Eigen::Vector3d::Zero());
    sample_points(rig, floor_depth(rig), 4, points);
    ASSERT_GT(points.size(), 500U);
    for (const auto& p : points) {
        // Float disparities: a relative error of 6e-8 of up to 20 m.
        EXPECT_NEAR(p.z(), 0.0, 5e-6) << p.transpose();
        EXPECT_GT(p.x(), 0.4);
    }
}

TEST(SamplePoints, FeedsTheGroundObservation) {
    const camera::RectifiedRig rig = tilted_rig();
    std::vector<Eigen::Vector3d> points;
    sample_points(rig, floor_depth(rig), 2, points);
    const auto sighting =
        sight_ground({}, points, Eigen::Vector3d::UnitZ(), rig.T_body_camera.translation_m, 1);
    ASSERT_TRUE(sighting.observation.accepted) << to_string(sighting.reason);
    EXPECT_NEAR(sighting.observation.height_m, kCameraHeight_m, 1e-5);
    EXPECT_NEAR(sighting.tilt_rad, 0.0, 1e-5);
}

TEST(SamplePoints, MatchingNoiseLeavesTheGroundAccurate) {
    // 0.06 px at this quarter of 672x376 is 0.25 px at full size: 5 mm of height at 1 m, 25 mm at 4
    // m.
    const camera::RectifiedRig rig = tilted_rig();
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        camera::DepthImage depth = floor_depth(rig);
        Rng rng(seed);
        for (std::size_t i = 0; i < depth.disparity_px.size(); ++i) {
            depth.disparity_px.data()[i] += static_cast<float>(0.06 * rng.normal());
        }
        std::vector<Eigen::Vector3d> points;
        sample_points(rig, depth, 1, points);
        const auto sighting = sight_ground(
            {}, points, Eigen::Vector3d::UnitZ(), rig.T_body_camera.translation_m, seed);
        ASSERT_TRUE(sighting.observation.accepted)
            << "seed " << seed << ' ' << to_string(sighting.reason);
        EXPECT_NEAR(sighting.observation.height_m, kCameraHeight_m, 0.01) << "seed " << seed;
        EXPECT_LE(sighting.tilt_rad, 0.5 * std::numbers::pi / 180.0) << "seed " << seed;
    }
}

TEST(SamplePoints, UnknownUnlikelyAndImpossiblePixelsAreLeftOut) {
    const camera::RectifiedRig rig = tilted_rig();
    camera::DepthImage depth;
    depth.resize(6, 1);
    depth.disparity_px.fill(10.0F);
    depth.outlier_probability.fill(0.0F);
    depth.disparity_px.at(0, 0) = kNaN;
    depth.disparity_px.at(1, 0) = 0.0F;
    depth.disparity_px.at(2, 0) = std::numeric_limits<float>::infinity();
    depth.outlier_probability.at(3, 0) = 0.9F;
    depth.outlier_probability.at(4, 0) = kNaN;
    std::vector<Eigen::Vector3d> points;
    sample_points(rig, depth, 1, points);
    EXPECT_EQ(points.size(), 1U);
    sample_points(rig, depth, 1, points, 1.0F);
    EXPECT_EQ(points.size(), 2U);
    sample_points(rig, camera::DepthImage{}, 1, points);
    EXPECT_TRUE(points.empty());
}

}  // namespace
}  // namespace surefoot::ground
