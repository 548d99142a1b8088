// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/visual/pose_solver.hpp"

#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "surefoot/core/unknown.hpp"
#include "surefoot/odometry/world_testing.hpp"

namespace surefoot::odometry {
namespace {

using testing::World;

double pose_error(const Pose& a, const Pose& b) {
    return difference(a, b).norm();
}

/// Consensus, then refinement, without prior knowledge.
PoseSolution solve(const World& world, const Rng& rng) {
    const auto rough = find_pose(world.rig, world.config, world.matches, Pose{}, rng);
    return refine_pose(world.rig, world.config, world.matches, rough.T_world_camera);
}

TEST(PoseSolver, ExactDataGivesTheExactPose) {
    const World world(1, 40, 0.0);
    const auto found = find_pose(world.rig, world.config, world.matches, Pose{}, Rng(5));
    ASSERT_TRUE(found.found);
    const auto refined = refine_pose(world.rig, world.config, world.matches, found.T_world_camera);
    ASSERT_TRUE(refined.found);
    EXPECT_EQ(refined.inliers, 40);
    EXPECT_LT(pose_error(refined.T_world_camera, world.T_world_camera), 1e-9);
}

/// Two-frame motion with noise in both frames. The squared error in units of the reported
/// covariance is 6 on average; 300 trials leave a scatter of 0.2. The rest of the band is for Huber
/// and gate.
TEST(PoseSolver, CovarianceIsHonest) {
    constexpr int kTrials = 300;
    double sum = 0.0;
    for (int trial = 0; trial < kTrials; ++trial) {
        const World world(1000 + static_cast<std::uint64_t>(trial), 80, 0.4);
        const auto pose = solve(world, Rng(7));
        ASSERT_TRUE(pose.found) << "trial " << trial;
        const Vector6 error = difference(pose.T_world_camera, world.T_world_camera);
        sum += error.dot(pose.covariance.ldlt().solve(error));
    }
    const double nees = sum / kTrials;
    std::printf("NEES of the relative pose, 6 dof: %.2f\n", nees);
    EXPECT_GT(nees, 4.5);
    EXPECT_LT(nees, 8.0);
}

TEST(PoseSolver, FortyPercentOutliersChangeNothing) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        World world(2000 + seed, 100, 0.3);
        Rng rng(seed);
        for (std::size_t i = 0; i < 40; ++i)
            world.matches[i].pixel_px += Eigen::Vector3d(
                rng.uniform(15.0, 80.0), rng.uniform(-60.0, 60.0), rng.uniform(-80.0, 80.0));
        const auto rough = find_pose(world.rig, world.config, world.matches, Pose{}, Rng(seed));
        ASSERT_TRUE(rough.found);
        const auto pose = refine_pose(world.rig, world.config, world.matches, rough.T_world_camera);
        ASSERT_TRUE(pose.found) << "seed " << seed;
        int wrong = 0;
        for (std::size_t i = 0; i < 40; ++i) wrong += pose.inlier[i];
        EXPECT_LE(wrong, 1) << "seed " << seed;
        EXPECT_LT(pose_error(pose.T_world_camera, world.T_world_camera), 0.012) << "seed " << seed;
    }
}

TEST(PoseSolver, WorksWithoutAnyDisparity) {
    World world(3, 60, 0.0);
    for (PointMatch& match : world.matches) match.pixel_px.z() = kNan;
    const auto pose = solve(world, Rng(7));
    ASSERT_TRUE(pose.found);
    EXPECT_LT(pose_error(pose.T_world_camera, world.T_world_camera), 1e-8);
}

TEST(PoseSolver, TooFewPointsAreNoPose) {
    const World world(4, kMinimalPoseMatches - 1, 0.0);
    EXPECT_FALSE(find_pose(world.rig, world.config, world.matches, Pose{}, Rng(1)).found);
    EXPECT_FALSE(refine_pose(world.rig, world.config, world.matches, Pose{}).found);
    EXPECT_FALSE(refine_pose(world.rig, world.config, {}, Pose{}).found);
}

TEST(PoseSolver, PointsOnALineAreNoPose) {
    World world(5, 30, 0.0);
    world.T_world_camera = Pose{};
    for (std::size_t i = 0; i < world.matches.size(); ++i) {
        const double s = static_cast<double>(i) / 30.0;
        world.matches[i].p_world_m = {-0.5 + s, 0.2 * s, 2.0 + 0.5 * s};
        world.matches[i].pixel_px = project_stereo(world.rig, world.matches[i].p_world_m);
    }
    const auto pose = refine_pose(world.rig, world.config, world.matches, Pose{});
    EXPECT_FALSE(pose.found);
}

TEST(PoseSolver, OnePointManyTimesIsNoPose) {
    World world(6, 30, 0.0);
    for (PointMatch& match : world.matches) {
        match.p_world_m = {0.1, 0.1, 2.0};
        match.pixel_px = project_stereo(world.rig, match.p_world_m);
    }
    EXPECT_FALSE(refine_pose(world.rig, world.config, world.matches, Pose{}).found);
}

TEST(PoseSolver, SameSeedSamePose) {
    World world(7, 80, 0.3);
    for (std::size_t i = 0; i < 30; ++i) world.matches[i].pixel_px.x() += 25.0;
    const auto a = find_pose(world.rig, world.config, world.matches, Pose{}, Rng(11));
    const auto b = find_pose(world.rig, world.config, world.matches, Pose{}, Rng(11));
    EXPECT_EQ(a.inlier, b.inlier);
    EXPECT_EQ(a.T_world_camera.translation_m, b.T_world_camera.translation_m);
    EXPECT_EQ(a.T_world_camera.rotation.coeffs(), b.T_world_camera.rotation.coeffs());
}

/// Solves the same least-squares problem in Ceres, with automatic differentiation.
struct CeresResidual {
    const camera::RectifiedRig& rig;
    const PointMatch& match;
    double sigma_px;

    template <typename T>
    bool operator()(const T* angle_axis, const T* translation, T* residual) const {
        const T shifted[3] = {T(match.p_world_m.x()) - translation[0],
                              T(match.p_world_m.y()) - translation[1],
                              T(match.p_world_m.z()) - translation[2]};
        const T inverse[3] = {-angle_axis[0], -angle_axis[1], -angle_axis[2]};
        T p[3];
        ceres::AngleAxisRotatePoint(inverse, shifted, p);
        residual[0] = (T(match.pixel_px.x()) - (rig.fx_px * p[0] / p[2] + rig.cx_px)) / sigma_px;
        residual[1] = (T(match.pixel_px.y()) - (rig.fy_px * p[1] / p[2] + rig.cy_px)) / sigma_px;
        residual[2] =
            (T(match.pixel_px.z()) - (rig.fx_px * (p[0] - rig.baseline_m) / p[2] + rig.cx_px)) /
            sigma_px;
        return true;
    }
};

TEST(PoseSolver, AgreesWithCeres) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        World world(3000 + seed, 50, 0.5);
        for (PointMatch& match : world.matches) match.covariance_m2.setZero();
        const auto ours = solve(world, Rng(7));
        ASSERT_TRUE(ours.found);
        double angle_axis[3] = {0.0, 0.0, 0.0};
        double translation[3] = {0.0, 0.0, 0.0};
        ceres::Problem problem;
        for (std::size_t i = 0; i < world.matches.size(); ++i)
            if (ours.inlier[i] != 0)
                problem.AddResidualBlock(
                    new ceres::AutoDiffCostFunction<CeresResidual, 3, 3, 3>(
                        new CeresResidual{world.rig, world.matches[i], world.config.sigma_px}),
                    new ceres::HuberLoss(world.config.huber_sigmas),
                    angle_axis,
                    translation);
        ceres::Solver::Options options;
        options.function_tolerance = 1e-15;
        options.parameter_tolerance = 1e-14;
        options.max_num_iterations = 200;
        ceres::Solver::Summary summary;
        ceres::Solve(options, &problem, &summary);
        const Pose theirs{exp_so3({angle_axis[0], angle_axis[1], angle_axis[2]}),
                          {translation[0], translation[1], translation[2]}};
        // Reweighting converges linearly and stops when the cost changes by less than 1e-9: within
        // 1 % of the sigma of about 2e-3.
        EXPECT_LT(pose_error(ours.T_world_camera, theirs), 3e-5) << "seed " << seed;
    }
}

TEST(PoseSolver, BodyCovarianceMatchesSampledMotion) {
    const Pose T_body_camera{exp_so3({0.3, -1.2, 0.7}), {0.4, -0.2, 0.9}};
    const Pose T_odom_body{exp_so3({0.1, 0.2, -0.4}), {1.0, 2.0, 3.0}};
    Vector6 sigma;
    sigma << 2e-3, 1e-3, 3e-3, 1e-3, 2e-3, 0.5e-3;
    const Matrix6 camera = sigma.cwiseAbs2().asDiagonal();
    const Matrix6 body = camera_to_body_covariance(camera, T_body_camera);
    Rng rng(3);
    Matrix6 sampled = Matrix6::Zero();
    constexpr int kSamples = 20000;
    for (int i = 0; i < kSamples; ++i) {
        Vector6 delta;
        for (int k = 0; k < 6; ++k) delta[k] = sigma[k] * rng.normal();
        const Pose moved = perturbed(T_odom_body * T_body_camera, delta) * T_body_camera.inverse();
        const Vector6 error = difference(T_odom_body, moved);
        sampled += error * error.transpose() / kSamples;
    }
    // 20000 samples: 1 % per element, relative to the scale of the matrix.
    EXPECT_LT((sampled - body).norm(), 0.04 * body.norm());
}

}  // namespace
}  // namespace surefoot::odometry
