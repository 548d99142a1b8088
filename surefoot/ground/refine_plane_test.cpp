// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/refine_plane.hpp"

#include <gtest/gtest.h>

#include "surefoot/core/angles.hpp"
#include "surefoot/ground/frames_testing.hpp"

namespace surefoot::ground {
namespace {

constexpr double kBand_m = 0.05;

geometry::Plane refined(const FramePoints& frame, const geometry::Plane& start) {
    const auto plane = refine_plane(frame.points_body_m, frame.inverse_range_sigma, start, kBand_m);
    EXPECT_TRUE(plane);
    return plane.value_or(start);
}

double tilt_rad(const geometry::Plane& plane) {
    return std::atan2(plane.normal.head<2>().norm(), plane.normal.z());
}

TEST(RefinePlane, IsExactWithoutNoiseFromAnyStartWithinTheBand) {
    const FramePoints frame = test::seen({{}}, {.noise_px = 1e-6});
    for (const auto& [tilt_deg, height_m] :
         {std::pair{0.0, 1.0}, {1.0, 1.0}, {-1.0, 0.99}, {0.0, 1.03}}) {
        const geometry::Plane start{
            exp_so3({0.0, tilt_deg * kRadPerDeg, 0.0}) * Eigen::Vector3d::UnitZ(), height_m};
        const geometry::Plane plane = refined(frame, start);
        EXPECT_LT(tilt_rad(plane), 1e-6) << tilt_deg;
        EXPECT_NEAR(plane.offset_m, 1.0, 1e-6) << tilt_deg;
    }
}

TEST(RefinePlane, NoiseAveragesOutWithoutABias) {
    // The mean over many frames improves with their number, so there is no bias. An unweighted
    // least squares plane of the same points is tilted by the noise of far points.
    constexpr int kFrames = 40;
    double height_m = 0.0;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double worst_rad = 0.0;
    for (std::uint64_t seed = 1; seed <= kFrames; ++seed) {
        const geometry::Plane plane =
            refined(test::seen({{}}, {.seed = seed}), {Eigen::Vector3d::UnitZ(), 1.0});
        height_m += plane.offset_m / kFrames;
        normal += plane.normal;
        worst_rad = std::max(worst_rad, tilt_rad(plane));
    }
    EXPECT_NEAR(height_m, 1.0, 2e-4);
    EXPECT_LT(tilt_rad({normal.normalized(), 1.0}), 0.01 * kRadPerDeg);
    EXPECT_LT(worst_rad, 0.1 * kRadPerDeg);
}

TEST(RefinePlane, WhatLiesOnItOrMayBeAnywhereTakesNoPart) {
    // A kerb, a mat of 40 mm on a tenth of the view, and points too noisy to use.
    FramePoints frame =
        test::seen({{}, {.z_m = 0.04, .min_x_m = 0.9, .max_x_m = 1.2, .min_y_m = 0.1}});
    Rng rng(3);
    for (int i = 0; i < 3000; ++i) {
        frame.points_body_m.emplace_back(
            rng.uniform(0.5, 2.0), rng.uniform(-1.0, 1.0), rng.uniform(-0.99, -0.9));
        frame.inverse_range_sigma.push_back(0.5);
    }
    const geometry::Plane plane = refined(frame, {Eigen::Vector3d::UnitZ(), 1.0});
    EXPECT_LT(tilt_rad(plane), 0.15 * kRadPerDeg);
    EXPECT_NEAR(plane.offset_m, 1.0, 0.003);
}

TEST(RefinePlane, NothingWherePointsDoNotFixAPlane) {
    const geometry::Plane start{Eigen::Vector3d::UnitZ(), 1.0};
    FramePoints line;
    for (int i = 0; i < 100; ++i) {
        line.points_body_m.emplace_back(0.5 + 0.01 * i, 0.0, -1.0);
        line.inverse_range_sigma.push_back(0.001);
    }
    EXPECT_FALSE(refine_plane(line.points_body_m, line.inverse_range_sigma, start, kBand_m));
    EXPECT_FALSE(refine_plane({}, {}, start, kBand_m));
    const FramePoints frame = test::seen({{}});
    EXPECT_FALSE(refine_plane(
        frame.points_body_m, frame.inverse_range_sigma, {Eigen::Vector3d::UnitZ(), -1.0}, kBand_m))
        << "a plane above the camera";
    EXPECT_FALSE(refine_plane(
        frame.points_body_m, frame.inverse_range_sigma, {Eigen::Vector3d::UnitZ(), 2.0}, kBand_m))
        << "no points there";
}

}  // namespace
}  // namespace surefoot::ground
