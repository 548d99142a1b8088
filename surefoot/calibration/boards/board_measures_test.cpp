// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/boards/board_measures.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/calibration/synthetic_views_testing.hpp"
#include "surefoot/camera/rigs_testing.hpp"

namespace surefoot::calibration {
namespace {

const Board kBoard{.columns = 7, .rows = 5, .spacing_m = 0.04};
constexpr int kLengths = 6 * 5 + 7 * 4;

/// A board with its middle on the optical axis, rotated about x and y.
Pose board_ahead(double distance_m, double tilt_rad) {
    Pose T;
    T.rotation = exp_so3({tilt_rad, -0.5 * tilt_rad, 0.1});
    T.translation_m = Eigen::Vector3d(0.0, 0.0, distance_m) -
                      T.rotation * (0.5 * (kBoard.points_m().front() + kBoard.points_m().back()));
    return T;
}

/// Measures with the rig `believed` the images that the rig `truth` takes.
BoardMeasures measured(const camera::StereoRig& truth,
                       const camera::StereoRig& believed,
                       const Pose& T_left_board,
                       double noise_px = 0.0,
                       std::uint64_t seed = 1) {
    Rng rng(seed);
    const auto result = measure_board(
        kBoard,
        testing::view_of(kBoard, truth.left, T_left_board, noise_px, rng),
        testing::view_of(
            kBoard, *truth.right, truth.T_left_right.inverse() * T_left_board, noise_px, rng),
        believed);
    EXPECT_TRUE(result) << "seed " << seed;
    return result.value_or(BoardMeasures{});
}

TEST(BoardMeasures, TheTrueRigMeasuresTheTrueBoard) {
    for (const camera::StereoRig& rig : {camera::test::euroc_rig(), camera::test::fisheye_rig()}) {
        for (const double distance_m : {0.4, 1.0, 2.0}) {
            const BoardMeasures found = measured(rig, rig, board_ahead(distance_m, 0.4));
            EXPECT_EQ(found.points, 35);
            EXPECT_EQ(found.lengths, kLengths);
            // The rectified camera is rotated against the rig by a degree or two.
            EXPECT_NEAR(found.distance_m, distance_m, 0.02 * distance_m);
            EXPECT_NEAR(found.axial_m, 0.0, 1e-7 * distance_m);
            EXPECT_NEAR(found.lateral_m, 0.0, 1e-7);
            EXPECT_LT(found.axial_std_m, 1e-7);
            EXPECT_LT(found.lateral_std_m, 1e-7);
        }
    }
}

TEST(BoardMeasures, ALongerBaselineShowsInBothByItsShare) {
    const camera::StereoRig truth = camera::test::euroc_rig();
    camera::StereoRig longer = truth;
    longer.T_left_right.translation_m *= 1.01;
    const BoardMeasures found = measured(truth, longer, board_ahead(1.0, 0.4));
    EXPECT_NEAR(found.axial_m, 0.01 * found.distance_m, 1e-6);
    EXPECT_NEAR(found.lateral_m, 0.01 * kBoard.spacing_m, 1e-6);
    EXPECT_LT(found.lateral_std_m, 1e-6) << "all lengths alike";
    EXPECT_LT(found.axial_std_m, 1e-6) << "a plane it is still";
}

TEST(BoardMeasures, ATurnedEyeErrsWithTheSquareOfTheDistance) {
    const camera::StereoRig truth = camera::test::euroc_rig();
    constexpr double kTurn_rad = 2e-4;
    camera::StereoRig turned = truth;
    turned.T_left_right.rotation = exp_so3({0.0, kTurn_rad, 0.0}) * truth.T_left_right.rotation;
    const double baseline_m = truth.T_left_right.translation_m.norm();
    for (const double distance_m : {1.0, 2.0, 4.0}) {
        const BoardMeasures found = measured(truth, turned, board_ahead(distance_m, 0.0));
        // The rotation reduces the disparity; for rays off the axis by up to 2 % more.
        const double expected_m = found.distance_m * found.distance_m * kTurn_rad / baseline_m;
        EXPECT_NEAR(found.axial_m, expected_m, 0.05 * expected_m) << distance_m;
        const double lateral_m = kBoard.spacing_m * expected_m / found.distance_m;
        EXPECT_NEAR(found.lateral_m, lateral_m, 0.05 * lateral_m) << distance_m;
    }
}

TEST(BoardMeasures, NoiseScattersDepthsAsDisparitiesDo) {
    const camera::StereoRig rig = camera::test::euroc_rig();
    constexpr double kNoise_px = 0.1;
    constexpr double kDistance_m = 1.0;
    double axial_var_m2 = 0.0;
    double axial_m = 0.0;
    constexpr int kSeeds = 20;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const BoardMeasures found =
            measured(rig, rig, board_ahead(kDistance_m, 0.0), kNoise_px, seed);
        axial_var_m2 += found.axial_std_m * found.axial_std_m / kSeeds;
        axial_m += found.axial_m / kSeeds;
        EXPECT_GT(found.lateral_std_m, 0.5 * kNoise_px * kDistance_m / 460.0);
        EXPECT_LT(found.lateral_std_m, 4.0 * kNoise_px * kDistance_m / 460.0);
    }
    // f of the EuRoC rig is 457 px. The fitted plane removes three of 35 degrees of freedom.
    const double baseline_m = rig.T_left_right.translation_m.norm();
    const double sigma_m =
        std::sqrt(2.0 * 32.0 / 35.0) * kNoise_px * kDistance_m * kDistance_m / (457.0 * baseline_m);
    EXPECT_NEAR(std::sqrt(axial_var_m2), sigma_m, 0.1 * sigma_m);
    EXPECT_LT(std::abs(axial_m), sigma_m / std::sqrt(35.0)) << "no bias";
}

TEST(BoardMeasures, SizeTellsTheDistanceOfATiltedBoardAsWellAsNoiseAllows) {
    const camera::StereoRig rig = camera::test::euroc_rig();
    double var_m2 = 0.0;
    constexpr int kSeeds = 20;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const BoardMeasures found = measured(rig, rig, board_ahead(0.4, 0.8), 0.3, seed);
        var_m2 += found.axial_m * found.axial_m / kSeeds;
    }
    // Triangulated mean: sqrt(2 / 35) sigma_px z^2 / (f b) = 0.23 mm. Depth from the size: 0.18 mm,
    // because the size is known to sigma_px over the root of the squared distances from the middle.
    EXPECT_NEAR(std::sqrt(var_m2), 0.3e-3, 0.1e-3);
}

TEST(BoardMeasures, WhatIsNotSeenIsNotMeasured) {
    const camera::StereoRig rig = camera::test::euroc_rig();
    Rng rng(1);
    const Pose T = board_ahead(0.6, 0.3);
    const BoardView left = testing::view_of(kBoard, rig.left, T, 0.0, rng);
    BoardView right =
        testing::view_of(kBoard, *rig.right, rig.T_left_right.inverse() * T, 0.0, rng);
    EXPECT_TRUE(measure_board(kBoard, left, right, rig));
    camera::StereoRig one_camera = rig;
    one_camera.right.reset();
    EXPECT_FALSE(measure_board(kBoard, left, right, one_camera));
    EXPECT_FALSE(measure_board(kBoard, right, left, rig)) << "exchanged: behind the camera";
    BoardView discs = left;
    discs.disc_radius_m = 0.01;
    EXPECT_FALSE(measure_board(kBoard, discs, right, rig));
    right.ids.resize(7);
    right.pixels.resize(7);
    EXPECT_FALSE(measure_board(kBoard, left, right, rig)) << "seven points, on a line";
    EXPECT_FALSE(measure_board(kBoard, left, {}, rig));
}

}  // namespace
}  // namespace surefoot::calibration
