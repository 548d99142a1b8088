// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/visual/bundle.hpp"

#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <gtest/gtest.h>

#include <limits>

#include "surefoot/core/rng.hpp"

namespace surefoot::odometry {
namespace {

constexpr double kNoise_px = 0.3;

camera::RectifiedRig test_rig() {
    camera::RectifiedRig rig;
    rig.fx_px = rig.fy_px = 400.0;
    rig.cx_px = 320.0;
    rig.cy_px = 240.0;
    rig.baseline_m = 0.1;
    return rig;
}

Pose angle_axis_pose(const double* v) {
    return {exp_so3({v[0], v[1], v[2]}), {v[3], v[4], v[5]}};
}

/// Six poses on a curve that all see 60 points. Poses and points start away from the truth.
BundleProblem make_problem(std::uint64_t seed, std::vector<Pose>* truth = nullptr) {
    Rng rng(seed);
    BundleProblem problem;
    std::vector<Pose> poses;
    for (int i = 0; i < 6; ++i) {
        const double s = 0.05 * i;
        poses.push_back({exp_so3({0.1 * s, -0.5 * s, 0.3 * s}), {s, 0.2 * s, 0.5 * s}});
        Vector6 off = Vector6::Zero();
        for (int k = 0; k < 6; ++k) off[k] = 0.004 * rng.normal();
        problem.T_world_camera.push_back(i == 0 ? poses.back() : perturbed(poses.back(), off));
        problem.fixed.push_back(i == 0 ? 1 : 0);
    }
    for (int j = 0; j < 60; ++j) {
        const Eigen::Vector3d p(
            rng.uniform(-1.0, 1.0), rng.uniform(-0.7, 0.7), rng.uniform(1.5, 4.0));
        problem.p_world_m.push_back(
            p + 0.02 * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()));
        for (int i = 0; i < 6; ++i) {
            StereoPixel pixel =
                project_stereo(test_rig(), poses[static_cast<std::size_t>(i)].inverse() * p);
            for (int k = 0; k < 3; ++k) pixel[k] += kNoise_px * rng.normal();
            if (rng.uniform() < 0.2) pixel.z() = std::numeric_limits<double>::quiet_NaN();
            problem.sights.push_back({i, j, pixel, 1.0});
        }
    }
    if (truth != nullptr) *truth = poses;
    return problem;
}

struct CeresSight {
    camera::RectifiedRig rig;
    BundleSight sight;
    double sigma_px;
    template <typename T>
    bool operator()(const T* pose, const T* point, T* residual) const {
        const T shifted[3] = {point[0] - pose[3], point[1] - pose[4], point[2] - pose[5]};
        const T inverse[3] = {-pose[0], -pose[1], -pose[2]};
        T p[3];
        ceres::AngleAxisRotatePoint(inverse, shifted, p);
        residual[0] = (sight.pixel_px.x() - rig.cx_px - rig.fx_px * p[0] / p[2]) / sigma_px;
        residual[1] = (sight.pixel_px.y() - rig.cy_px - rig.fy_px * p[1] / p[2]) / sigma_px;
        residual[2] =
            std::isfinite(sight.pixel_px.z())
                ? (sight.pixel_px.z() - rig.cx_px - rig.fx_px * (p[0] - rig.baseline_m) / p[2]) /
                      sigma_px
                : T(0.0);
        return true;
    }
};

TEST(Bundle, AgreesWithCeres) {
    BundleConfig config;
    config.sigma_px = kNoise_px;
    config.iterations = 60;
    BundleProblem problem = make_problem(1);
    std::vector<std::array<double, 6>> poses;
    for (const Pose& T : problem.T_world_camera) {
        const Eigen::Vector3d r = log_so3(T.rotation);
        poses.push_back(
            {r.x(), r.y(), r.z(), T.translation_m.x(), T.translation_m.y(), T.translation_m.z()});
    }
    std::vector<Eigen::Vector3d> points = problem.p_world_m;
    ceres::Problem ceres_problem;
    for (const BundleSight& sight : problem.sights)
        ceres_problem.AddResidualBlock(new ceres::AutoDiffCostFunction<CeresSight, 3, 6, 3>(
                                           new CeresSight{test_rig(), sight, config.sigma_px}),
                                       new ceres::HuberLoss(config.huber_sigmas),
                                       poses[static_cast<std::size_t>(sight.pose)].data(),
                                       points[static_cast<std::size_t>(sight.point)].data());
    ceres_problem.SetParameterBlockConstant(poses[0].data());
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.function_tolerance = 1e-14;
    options.max_num_iterations = 200;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &ceres_problem, &summary);
    const BundleResult ours = adjust_bundle(test_rig(), config, problem);
    // Ceres halves the cost. Our solver stops when a step gains less than 1e-4 of the cost.
    EXPECT_NEAR(ours.cost_after, 2.0 * summary.final_cost, 1e-3 * ours.cost_after);
    for (std::size_t i = 0; i < poses.size(); ++i)
        EXPECT_LT(difference(problem.T_world_camera[i], angle_axis_pose(poses[i].data())).norm(),
                  2e-4)
            << "pose " << i;
}

TEST(Bundle, BringsPosesToTheTruthAndLeavesFixedOnes) {
    std::vector<Pose> truth;
    BundleProblem problem = make_problem(2, &truth);
    const Pose first = problem.T_world_camera[0];
    BundleConfig config;
    config.sigma_px = kNoise_px;
    config.iterations = 10;
    const BundleResult result = adjust_bundle(test_rig(), config, problem);
    EXPECT_LT(result.cost_after, 0.2 * result.cost_before);
    EXPECT_EQ(problem.T_world_camera[0].translation_m, first.translation_m);
    // 0.3 px / 400 px * 2.5 m / sqrt(60) = 0.25 mm for a pure translation. A translation that a
    // rotation can hide costs up to ten times as much with points in a narrow cone.
    for (std::size_t i = 1; i < truth.size(); ++i)
        EXPECT_LT(difference(truth[i], problem.T_world_camera[i]).norm(), 3e-3) << "pose " << i;
}

TEST(Bundle, OneWrongSightIsNamedAndHarmless) {
    BundleConfig config;
    config.sigma_px = kNoise_px;
    config.iterations = 20;
    BundleProblem good = make_problem(3);
    BundleProblem bad = good;
    bad.sights[10].pixel_px.x() += 30.0;
    static_cast<void>(adjust_bundle(test_rig(), config, good));
    const BundleResult result = adjust_bundle(test_rig(), config, bad);
    EXPECT_GT(result.residual_sigmas[10], 20.0);
    // 100 sigmas off, it pulls like one residual of huber_sigmas among 360 sights.
    EXPECT_LT(difference(good.T_world_camera[5], bad.T_world_camera[5]).norm(), 1e-3);
}

TEST(Bundle, NothingToDoIsNotAnError) {
    BundleProblem problem;
    EXPECT_EQ(adjust_bundle(test_rig(), {}, problem).steps, 0);
    problem = make_problem(4);
    for (auto& fixed : problem.fixed) fixed = 1;
    EXPECT_EQ(adjust_bundle(test_rig(), {}, problem).steps, 0);
}

}  // namespace
}  // namespace surefoot::odometry
