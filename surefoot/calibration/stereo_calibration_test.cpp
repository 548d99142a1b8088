// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/stereo_calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/calibration/lenses/rectified_errors.hpp"
#include "surefoot/calibration/synthetic_views_testing.hpp"
#include "surefoot/camera/rigs_testing.hpp"

namespace surefoot::calibration {
namespace {

using testing::synthetic_views;
using testing::SyntheticViews;
using testing::Uncertainty;
using testing::view_of;

constexpr double kNoise_px = 0.1;
const Board kBoard{.columns = 7, .rows = 5, .spacing_m = 0.04};

/// The values fx fy cx cy and coefficients of a lens of the rigs below.
Eigen::VectorXd parameters_of(const camera::CameraModel& model) {
    Eigen::VectorXd p(8);
    if (const auto* f = std::get_if<camera::KannalaBrandt>(&model))
        p << f->fx_px, f->fy_px, f->cx_px, f->cy_px, f->k1, f->k2, f->k3, f->k4;
    else if (const auto* l = std::get_if<camera::PinholeRadTan>(&model))
        p << l->fx_px, l->fy_px, l->cx_px, l->cy_px, l->k1, l->k2, l->p1, l->p2;
    return p;
}

struct Case {
    const char* name;
    LensKind kind;
    camera::StereoRig rig;
};

std::vector<Case> cases() {
    return {{"pinhole", LensKind::pinhole4, camera::test::euroc_rig()},
            {"fisheye", LensKind::fisheye, camera::test::fisheye_rig()}};
}

ImageSize size_of(const camera::StereoRig& rig) {
    return {rig.left.width, rig.left.height};
}

Eigen::VectorXd error_of(const camera::StereoRig& truth, const camera::StereoRig& found) {
    Eigen::VectorXd error(22);
    error << parameters_of(found.left.model) - parameters_of(truth.left.model),
        parameters_of(found.right->model) - parameters_of(truth.right->model),
        difference(truth.T_left_right, found.T_left_right);
    return error;
}

/// Depth error of a point 1 m ahead of the rectified camera of the rig `found`, when the rig
/// `truth` takes the images.
double depth_error_m(const camera::StereoRig& truth, const camera::StereoRig& found) {
    camera::RectificationConfig config;
    config.max_view_deg = 105.0;
    const camera::Rectification plan = camera::plan_rectification(found, config, 0.08);
    const Eigen::Vector3d p_left = plan.left.R_rectified_raw.transpose() * Eigen::Vector3d::UnitZ();
    const auto on_plane = [](const camera::RectifiedCamera& camera, const Eigen::Vector2d& raw) {
        const Eigen::Vector3d p =
            camera.R_rectified_raw * *camera::unproject(camera.camera.model, raw);
        return p.x() / p.z();
    };
    const auto left = camera::project(truth.left.model, p_left);
    const auto right = camera::project(truth.right->model, truth.T_left_right.inverse() * p_left);
    return plan.rig.baseline_m / (on_plane(plan.left, *left) - on_plane(*plan.right, *right)) - 1.0;
}

class EveryRig : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Rigs, EveryRig, ::testing::ValuesIn(cases()), [](const auto& tested) {
    return std::string(tested.param.name);
});

TEST_P(EveryRig, IsFoundWithinItsOwnUncertainty) {
    const Case& c = GetParam();
    constexpr int kSeeds = 3;
    Uncertainty uncertainty;
    double depth_sum = 0.0;
    for (int seed = 0; seed < kSeeds; ++seed) {
        Rng rng(static_cast<std::uint64_t>(200 + seed));
        const SyntheticViews views = synthetic_views(kBoard, c.rig, 10, kNoise_px, rng);
        const auto result =
            calibrate_stereo(kBoard, views.left, views.right, size_of(c.rig), c.kind);
        ASSERT_TRUE(result) << "seed " << seed << ": " << result.error().message;
        EXPECT_EQ(result->pairs.size(), 10U) << "seed " << seed;
        EXPECT_NEAR(result->sigma_px, kNoise_px, 0.01) << "seed " << seed;
        uncertainty.add(error_of(c.rig, result->rig), result->covariance);
        const double depth = depth_error_m(c.rig, result->rig) / result->depth_errors[1].sigma_m;
        depth_sum += depth * depth;
        EXPECT_LT(std::abs(depth), 3.0) << "seed " << seed;
    }
    uncertainty.expect_true();
    EXPECT_GT(depth_sum, 0.024) << "99.9 % of chi square with 3 degrees of freedom lie above";
}

TEST(StereoCalibration, FindsPairsThatWereNotTakenTogether) {
    const camera::StereoRig rig = camera::test::euroc_rig();
    Rng rng(5);
    SyntheticViews views = synthetic_views(kBoard, rig, 14, kNoise_px, rng);
    for (const std::size_t late : {3U, 7U, 8U}) {  // the hand moves 5 mm before the right image
        Pose T = views.T_left_board[late];
        T.translation_m += Eigen::Vector3d(0.003, -0.004, 0.0);
        views.right[late] =
            view_of(kBoard, *rig.right, rig.T_left_right.inverse() * T, kNoise_px, rng);
    }
    std::swap(views.right[10], views.right[11]);
    const auto result =
        calibrate_stereo(kBoard, views.left, views.right, size_of(rig), LensKind::pinhole4);
    ASSERT_TRUE(result) << result.error().message;
    std::vector<std::size_t> rejected;
    for (const RejectedView& view : result->rejected) {
        rejected.push_back(view.index);
        EXPECT_NE(view.reason.find("same moment"), std::string::npos) << view.reason;
    }
    EXPECT_EQ(rejected, (std::vector<std::size_t>{3, 7, 8, 10, 11}));
    EXPECT_NEAR(result->sigma_px, kNoise_px, 0.01);
}

TEST(StereoCalibration, PairsOfFewPointsAreJudgedByWhatNoiseLeavesThem) {
    // Separately, two poses fit the noise of 9 points in two images; jointly, one pose does. The
    // expected ratio is sqrt(30 / 24) times the rms. Without this correction a factor of 1.05
    // removes more than half of the pairs.
    const camera::StereoRig rig = camera::test::euroc_rig();
    const Board few{.columns = 3, .rows = 3, .spacing_m = 0.08};
    StereoOptions strict;
    strict.pair_factor = 1.05;
    int sent_away = 0;
    int pairs = 0;
    for (std::uint64_t seed = 1; seed <= 16; ++seed) {
        Rng rng(seed);
        const SyntheticViews views = synthetic_views(few, rig, 20, kNoise_px, rng);
        const auto result = calibrate_stereo(
            few, views.left, views.right, size_of(rig), LensKind::pinhole4, strict);
        ASSERT_TRUE(result) << "seed " << seed << ": " << result.error().message;
        for (const RejectedView& view : result->rejected)
            sent_away += view.reason.find("same moment") != std::string::npos ? 1 : 0;
        pairs += static_cast<int>(result->pairs.size());
    }
    EXPECT_GT(pairs, 60);
    EXPECT_LE(5 * sent_away, pairs) << sent_away << " beside " << pairs;
}

TEST(StereoCalibration, RefusesWhatIsNoPair) {
    const camera::StereoRig rig = camera::test::euroc_rig();
    Rng rng(6);
    const SyntheticViews views = synthetic_views(kBoard, rig, 6, kNoise_px, rng);
    const auto refusal = [&](std::span<const BoardView> left, std::span<const BoardView> right) {
        const auto result = calibrate_stereo(kBoard, left, right, size_of(rig), LensKind::pinhole4);
        return result ? "" : result.error().message;
    };
    EXPECT_NE(refusal(views.left, {}).find("6 left views, but 0 right views"), std::string::npos);
    EXPECT_NE(refusal({}, {}).find("at least 3"), std::string::npos);
    EXPECT_NE(refusal(views.right, views.left).find("swap the cameras"), std::string::npos);
    const std::vector<BoardView> none(6);
    EXPECT_NE(refusal(views.left, none).find("right: the board was not found"), std::string::npos);
}

TEST(StereoCalibration, DepthErrorGrowsFromAKnownOne) {
    // Only the baseline has an error: the relative depth error is the same.
    const camera::StereoRig rig = camera::test::euroc_rig();
    const StereoParameters parameters{LensKind::pinhole4,
                                      size_of(rig),
                                      parameters_of(rig.left.model),
                                      parameters_of(rig.right->model),
                                      rig.T_left_right};
    const Eigen::Vector3d along =
        rig.T_left_right.R().transpose() * rig.T_left_right.translation_m.normalized();
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(22, 22);
    covariance.block<3, 3>(16, 16) = 1e-6 * along * along.transpose();  // 1 mm
    const std::vector<double> distances_m{0.5, 2.0, 0.01};
    const std::vector<double> sigmas_m = depth_sigmas_m(parameters, covariance, distances_m);
    const double share = 1e-3 / rig.T_left_right.translation_m.norm();
    EXPECT_NEAR(sigmas_m[0], 0.5 * share, 1e-7);
    EXPECT_NEAR(sigmas_m[1], 2.0 * share, 1e-7);
    EXPECT_TRUE(std::isnan(sigmas_m[2])) << "the right camera does not see a point 10 mm ahead";
}

}  // namespace
}  // namespace surefoot::calibration
