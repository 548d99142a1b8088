// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/visual/measured_noise.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "surefoot/odometry/world_testing.hpp"

namespace surefoot::odometry {
namespace {

using testing::World;

constexpr double kExpected_px = 0.2;

/// Returns `world` for an odometry that is configured with `sigma_px` instead of `noise_px`. The
/// covariances of the landmarks change accordingly.
World taken_for(World world, double noise_px, double sigma_px) {
    const double share = sigma_px / noise_px;
    world.config.sigma_px = sigma_px;
    for (PointMatch& match : world.matches) match.covariance_m2 *= share * share;
    return world;
}

World world_of(std::uint64_t seed, double noise_px, double sigma_px) {
    return taken_for(World(seed, 80, noise_px), noise_px, sigma_px);
}

PoseSolution solve(const World& world) {
    return refine_pose(world.rig, world.config, world.matches, world.T_world_camera);
}

void listen(const World& world, MeasuredNoise& noise) {
    noise.listen(world.rig, world.config, world.matches, solve(world).T_world_camera);
}

struct Honesty {
    double nees = 0.0;  ///< mean of error^T covariance^-1 error
    double sigma_px = 0.0;
};

/// 300 pairs of frames. `learns`: uses the measured noise, else the expected noise.
Honesty honesty(double noise_px, bool learns) {
    constexpr int kTrials = 300;
    MeasuredNoise noise(kExpected_px);
    double sum = 0.0;
    for (int trial = 0; trial < kTrials; ++trial) {
        const double sigma_px = learns ? noise.sigma_px() : kExpected_px;
        const World world = world_of(5000 + static_cast<std::uint64_t>(trial), noise_px, sigma_px);
        const PoseSolution pose = solve(world);
        EXPECT_TRUE(pose.found) << trial;
        noise.listen(world.rig, world.config, world.matches, pose.T_world_camera);
        const Vector6 error = difference(pose.T_world_camera, world.T_world_camera);
        sum += error.dot(pose.covariance.ldlt().solve(error));
    }
    return {sum / kTrials, noise.sigma_px()};
}

TEST(MeasuredNoise, TwiceTheNoiseGivesACovarianceThatIsTrue) {
    const Honesty expected = honesty(2.0 * kExpected_px, false);
    const Honesty measured = honesty(2.0 * kExpected_px, true);
    std::printf("NEES, 6 dof: %.2f, by the expected noise %.2f; noise %.2f times the expected\n",
                measured.nees,
                expected.nees,
                measured.sigma_px / kExpected_px);
    EXPECT_NEAR(measured.sigma_px, 2.0 * kExpected_px, 0.1 * kExpected_px);
    EXPECT_GT(measured.nees, 4.5);  // same limit as in PoseSolver.CovarianceIsHonest
    EXPECT_LT(measured.nees, 8.0);
    EXPECT_GT(expected.nees, 9.0);
}

TEST(MeasuredNoise, IsNeverBelowTheExpectedNorBeyondThrice) {
    MeasuredNoise noise(kExpected_px);
    EXPECT_EQ(noise.sigma_px(), kExpected_px);
    for (std::uint64_t k = 0; k < 30; ++k)
        listen(world_of(6000 + k, 0.3 * kExpected_px, kExpected_px), noise);
    EXPECT_EQ(noise.sigma_px(), kExpected_px);
    for (std::uint64_t k = 0; k < 60; ++k)
        listen(world_of(6100 + k, 5.0 * kExpected_px, noise.sigma_px()), noise);
    EXPECT_EQ(noise.sigma_px(), 3.0 * kExpected_px);
}

TEST(MeasuredNoise, OutliersDoNotOpenTheGates) {
    MeasuredNoise noise(kExpected_px);
    for (std::uint64_t k = 0; k < 60; ++k) {
        World world = world_of(7000 + k, kExpected_px, kExpected_px);
        for (std::size_t i = 0; i < 20; ++i) world.matches[i].pixel_px.x() += 2.0;
        for (std::size_t i = 20; i < 35; ++i) world.matches[i].pixel_px.x() += 30.0;
        noise.listen(world.rig, world.config, world.matches, world.T_world_camera);
    }
    EXPECT_LT(noise.sigma_px(), 1.5 * kExpected_px);
}

TEST(MeasuredNoise, TooFewPointsTellNothing) {
    MeasuredNoise noise(kExpected_px);
    World world = world_of(8000, 5.0 * kExpected_px, kExpected_px);
    world.matches.resize(10);
    noise.listen(world.rig, world.config, world.matches, world.T_world_camera);
    EXPECT_EQ(noise.sigma_px(), kExpected_px);
}

}  // namespace
}  // namespace surefoot::odometry
