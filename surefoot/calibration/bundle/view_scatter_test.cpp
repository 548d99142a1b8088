// SPDX-License-Identifier: Apache-2.0
// If views disagree about the cameras by more than corner noise, the stated uncertainty grows.
#include "surefoot/calibration/bundle/view_scatter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "surefoot/calibration/mono_calibration.hpp"
#include "surefoot/calibration/stereo_calibration.hpp"
#include "surefoot/calibration/synthetic_views_testing.hpp"
#include "surefoot/camera/rigs_testing.hpp"

namespace surefoot::calibration {
namespace {

constexpr double kNoise_px = 0.05;
constexpr int kViews = 14;
const Board kBoard{.columns = 7, .rows = 5, .spacing_m = 0.04};

/// A sheet that bends by `bow_m` between its middle and its ends, differently in every view, seen
/// by both cameras.
testing::SyntheticViews bowed_views(const camera::StereoRig& rig, double bow_m, Rng& rng) {
    const double half_m = 0.5 * kBoard.points_m().back().x();
    testing::SyntheticViews views = testing::synthetic_views(kBoard, rig, kViews, kNoise_px, rng);
    for (std::size_t v = 0; v < views.left.size(); ++v) {
        const double bow = bow_m * rng.normal();
        const auto bend = [&](const camera::Camera& camera, const Pose& T, BoardView& view) {
            for (std::size_t i = 0; i < view.ids.size(); ++i) {
                Eigen::Vector3d p_m = kBoard.points_m()[static_cast<std::size_t>(view.ids[i])];
                const auto flat = camera::project(camera.model, T * p_m);
                const double from_middle = p_m.x() / half_m - 1.0;
                p_m.z() = bow * (1.0 - from_middle * from_middle);
                const auto bent = camera::project(camera.model, T * p_m);
                if (flat && bent) view.pixels[i] += *bent - *flat;
            }
        };
        const Pose& T_left_board = views.T_left_board[v];
        bend(rig.left, T_left_board, views.left[v]);
        bend(*rig.right, rig.T_left_right.inverse() * T_left_board, views.right[v]);
    }
    return views;
}

struct Stated {
    double error_m = 0.0;  ///< error of the baseline
    double sigma_m = 0.0;  ///< stated sigma of the baseline
    double alone_m = 0.0;  ///< sigma from the noise of single corners alone
};

Stated baseline_of(const camera::StereoRig& rig, const testing::SyntheticViews& views) {
    const ImageSize size{rig.left.width, rig.left.height};
    StereoOptions options;
    options.pair_factor = 1e3;  // keeps all pairs: the test needs their errors
    options.camera.limits.least_px = 10.0;
    const auto result =
        calibrate_stereo(kBoard, views.left, views.right, size, LensKind::pinhole4, options);
    EXPECT_TRUE(result) << result.error().message;
    if (!result) return {};
    const Pose& T = result->rig.T_left_right;
    const Eigen::Vector3d along = T.R().transpose() * T.translation_m.normalized();
    const Eigen::Matrix3d block =
        result->covariance.bottomRightCorner<6, 6>().topLeftCorner<3, 3>();
    Stated stated;
    stated.error_m = T.translation_m.norm() - rig.T_left_right.translation_m.norm();
    stated.sigma_m = std::sqrt(along.dot(block * along));
    stated.alone_m = stated.sigma_m * result->sigma_px / result->stated_sigma_px;
    return stated;
}

TEST(ViewScatter, IndependentNoiseIsNoDisagreement) {
    const camera::StereoRig rig = camera::test::euroc_rig();
    double square = 0.0;
    constexpr int kSeeds = 6;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        Rng rng(seed);
        const auto views = testing::synthetic_views(kBoard, rig, kViews, kNoise_px, rng);
        const auto result = calibrate_stereo(
            kBoard, views.left, views.right, {rig.left.width, rig.left.height}, LensKind::pinhole4);
        ASSERT_TRUE(result) << result.error().message;
        EXPECT_GE(result->stated_sigma_px, result->sigma_px);
        EXPECT_LT(result->stated_sigma_px, 1.25 * result->sigma_px) << "seed " << seed;
        square += std::pow(result->stated_sigma_px / kNoise_px, 2) / kSeeds;
    }
    // About 290 degrees of freedom each. The stated value is never below the corner noise.
    EXPECT_NEAR(std::sqrt(square), 1.03, 0.06);
}

TEST(ViewScatter, BentBoardsAreCoveredWhereCornerNoiseAloneDoesNot) {
    const camera::StereoRig rig = camera::test::euroc_rig();
    double stated = 0.0;
    double alone = 0.0;
    constexpr int kSeeds = 20;
    for (std::uint64_t seed = 41; seed < 41 + kSeeds; ++seed) {
        Rng rng(seed);
        const Stated baseline = baseline_of(rig, bowed_views(rig, 5e-4, rng));
        EXPECT_LT(std::abs(baseline.error_m), 3.0 * baseline.sigma_m) << "seed " << seed;
        stated += std::pow(baseline.error_m / baseline.sigma_m, 2) / kSeeds;
        alone += std::pow(baseline.error_m / baseline.alone_m, 2) / kSeeds;
    }
    // For twenty squared normal values, 99.8 % of the means lie between 0.30 and 2.27.
    EXPECT_LT(stated, 2.27);
    EXPECT_GT(stated, 0.15) << "or sigma is far too large";
    EXPECT_GT(alone, 2.27) << "the noise of single corners alone says too little";
}

TEST(ViewScatter, OneViewCannotDisagree) {
    BoardBundle bundle;
    bundle.kind = LensKind::pinhole4;
    bundle.size = {640, 480};
    bundle.lenses = {Eigen::VectorXd::Zero(8)};
    bundle.lenses[0].head<4>() << 400.0, 400.0, 320.0, 240.0;
    bundle.T_left_board = {Pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.0}}};
    EXPECT_TRUE(std::isnan(between_views_sigma_px(bundle)));
    EXPECT_EQ(stated_sigma_px(bundle, 0.07), 0.07);
}

}  // namespace
}  // namespace surefoot::calibration
