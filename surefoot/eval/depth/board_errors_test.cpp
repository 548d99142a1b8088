// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/depth/board_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "surefoot/core/rng.hpp"

namespace surefoot::eval {
namespace {

constexpr double kFocalTimesBaseline_px_m = 41.0;

/// Points of a plane with 1/z = (x, y, 1) . inverse_depth, `noise_px` added to the disparities.
std::vector<Eigen::Vector3d> board(const Eigen::Vector3d& inverse_depth_1_m,
                                   double noise_px,
                                   std::uint64_t seed) {
    Rng rng(seed);
    std::vector<Eigen::Vector3d> points_m;
    for (int v = -40; v <= 40; ++v) {
        for (int u = -40; u <= 40; ++u) {
            const Eigen::Vector3d direction(u / 342.0, v / 342.0, 1.0);
            const double disparity_px =
                kFocalTimesBaseline_px_m * inverse_depth_1_m.dot(direction) +
                noise_px * rng.normal();
            points_m.push_back(direction * (kFocalTimesBaseline_px_m / disparity_px));
        }
    }
    return points_m;
}

TEST(BoardErrors, ExactPointsGiveTheirPlane) {
    const Eigen::Vector3d tilted(0.11, -0.07, 1.0 / 0.8);
    const auto points_m = board(tilted, 0.0, 1);
    const auto plane = fit_board(points_m);
    ASSERT_TRUE(plane);
    EXPECT_LT((plane->inverse_depth_1_m - tilted).norm(), 1e-9);
    const auto errors = board_errors(points_m, 0.75);
    ASSERT_TRUE(errors);
    EXPECT_NEAR(errors->axial_m, 0.05, 1e-9);
    EXPECT_NEAR(errors->scale_share, 0.05 / 0.75, 1e-9);
    EXPECT_NEAR(errors->std_m, 0.0, 1e-9);
    EXPECT_EQ(errors->points, 81 * 81);
}

TEST(BoardErrors, NoiseOfTheDisparityBecomesZSquaredOverFB) {
    constexpr double kSigma_px = 0.2;
    for (const double z_m : {0.5, 1.0, 2.0}) {
        const auto errors = board_errors(board({0, 0, 1.0 / z_m}, kSigma_px, 3), z_m);
        ASSERT_TRUE(errors);
        const double expected_m = z_m * z_m / kFocalTimesBaseline_px_m * kSigma_px;
        // 6561 samples: the deviation is known to 0.9 %, the mean to 1.2 % of it; four sigma.
        EXPECT_NEAR(errors->std_m, expected_m, 0.036 * expected_m);
        EXPECT_NEAR(errors->axial_m, 0.0, 0.05 * expected_m);
    }
}

TEST(BoardErrors, OutliersDoNotMoveThePlaneButCountAsDeviation) {
    auto points_m = board({0, 0, 1.0}, 0.05, 4);
    for (std::size_t i = 0; i < points_m.size(); i += 10) points_m[i] *= 1.5;
    const auto errors = board_errors(points_m, 1.0);
    ASSERT_TRUE(errors);
    EXPECT_NEAR(errors->axial_m, 0.0, 1e-4);
    EXPECT_NEAR(errors->std_m, 0.5 * std::sqrt(0.1), 0.01);
}

TEST(BoardErrors, NothingForWhatIsNoBoard) {
    EXPECT_FALSE(board_errors({}, 1.0));
    const std::vector<Eigen::Vector3d> line(500, Eigen::Vector3d(0.1, 0.2, 1.0));
    EXPECT_FALSE(board_errors(line, 1.0));
}

TEST(BoardErrors, MeanOfLooks) {
    const BoardErrors looks[] = {{0.01, 0.03, 0.01, 100}, {-0.02, 0.04, -0.02, 50}};
    const BoardErrors mean = mean_of(looks);
    EXPECT_NEAR(mean.axial_m, -0.005, 1e-15);
    EXPECT_NEAR(mean.std_m, std::sqrt(0.5 * (9e-4 + 16e-4)), 1e-15);
    EXPECT_NEAR(mean.scale_share, -0.005, 1e-15);
    EXPECT_EQ(mean.points, 150);
}

}  // namespace
}  // namespace surefoot::eval
