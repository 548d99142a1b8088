// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/mono_calibration.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/calibration/lenses/lens_mapping.hpp"
#include "surefoot/calibration/synthetic_views_testing.hpp"

namespace surefoot::calibration {
namespace {

using testing::synthetic_views;
using testing::SyntheticViews;
using testing::Uncertainty;
using testing::view_of;

constexpr double kNoise_px = 0.1;
constexpr ImageSize kSize{752, 480};
const Board kBoard{.columns = 7, .rows = 5, .spacing_m = 0.04};

struct Case {
    const char* name;
    LensKind kind;
    Eigen::VectorXd truth;
};

Eigen::VectorXd values(std::initializer_list<double> list) {
    Eigen::VectorXd result(static_cast<Eigen::Index>(list.size()));
    std::copy(list.begin(), list.end(), result.begin());
    return result;
}

std::vector<Case> cases() {
    return {{"pinhole4",
             LensKind::pinhole4,
             values({458.7, 457.3, 367.2, 248.4, -0.283, 0.074, 0.0002, 0.00002})},
            {"pinhole5",
             LensKind::pinhole5,
             values({620.0, 621.5, 380.1, 231.0, -0.31, 0.13, 0.001, -0.0007, -0.04})},
            {"fisheye",
             LensKind::fisheye,
             values({227.0, 226.4, 372.2, 246.9, 0.0121, 0.0056, -0.0061, 0.0005})}};
}

camera::StereoRig rig_of(LensKind kind, const Eigen::VectorXd& truth) {
    camera::StereoRig rig;
    rig.left = {model_of(kind, truth), kSize.width, kSize.height};
    return rig;
}

SyntheticViews pinhole_views(int count, Rng& rng, double tilt_rad = 0.7) {
    return synthetic_views(
        kBoard, rig_of(LensKind::pinhole5, cases()[1].truth), count, kNoise_px, rng, tilt_rad);
}

class EveryLens : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Kinds, EveryLens, ::testing::ValuesIn(cases()), [](const auto& tested) {
    return std::string(tested.param.name);
});

TEST_P(EveryLens, FindsTheTruthWithinItsOwnUncertainty) {
    const Case& c = GetParam();
    constexpr int kSeeds = 5;
    Uncertainty uncertainty;
    for (int seed = 0; seed < kSeeds; ++seed) {
        Rng rng(static_cast<std::uint64_t>(100 + seed));
        const SyntheticViews views =
            synthetic_views(kBoard, rig_of(c.kind, c.truth), 12, kNoise_px, rng);
        const auto result = calibrate_mono(kBoard, views.left, kSize, c.kind);
        ASSERT_TRUE(result) << "seed " << seed << ": " << result.error().message;
        EXPECT_EQ(result->views.size(), 12U) << "seed " << seed;
        EXPECT_NEAR(result->sigma_px, kNoise_px, 0.01) << "seed " << seed;
        EXPECT_GE(result->stated_sigma_px, result->sigma_px) << "seed " << seed;
        uncertainty.add(result->parameters - c.truth, result->covariance);
    }
    uncertainty.expect_true();
}

TEST(MonoCalibration, RationalLensNeverDiverges) {
    const Eigen::VectorXd truth =
        values({420.0, 421.0, 370.0, 244.0, 0.51, -0.6, 0.0004, -0.0002, 0.3, 0.8, -0.6, 0.35});
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        Rng rng(seed);
        const SyntheticViews views =
            synthetic_views(kBoard, rig_of(LensKind::rational, truth), 12, kNoise_px, rng);
        const auto result = calibrate_mono(kBoard, views.left, kSize, LensKind::rational);
        ASSERT_TRUE(result) << result.error().message;
        EXPECT_NEAR(result->sigma_px, kNoise_px, 0.01);
        for (const int i : {0, 1, 2, 3}) {
            EXPECT_NEAR(result->parameters[i], truth[i], 3.0 * std::sqrt(result->covariance(i, i)))
                << parameter_names(LensKind::rational)[static_cast<std::size_t>(i)];
        }
    }
}

/// Boards in the middle of the image only: the user forgets the corners.
std::vector<BoardView> views_in_the_middle(const camera::Camera& camera, Rng& rng) {
    std::vector<BoardView> views;
    while (views.size() < 10) {
        const Pose T = testing::random_pose(kBoard, camera, 0.7, rng);
        BoardView view = view_of(kBoard, camera, T, kNoise_px, rng);
        const bool in_the_middle =
            std::all_of(view.pixels.begin(), view.pixels.end(), [&](const Eigen::Vector2d& p) {
                return std::abs(p.x() - 0.5 * camera.width) < 0.25 * camera.width;
            });
        if (in_the_middle && view.ids.size() == kBoard.points_m().size())
            views.push_back(std::move(view));
    }
    return views;
}

TEST(MonoCalibration, AFisheyeReachesItsCornersWhereNoBoardWas) {
    constexpr double kThreeSigma_sq = 11.83;  // two degrees of freedom
    const Eigen::VectorXd lens =
        values({280.0, 279.4, 372.2, 246.9, 0.0121, 0.0056, -0.0061, 0.0005});
    const camera::Camera truth{model_of(LensKind::fisheye, lens), kSize.width, kSize.height};
    for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
        Rng rng(seed);
        const auto result =
            calibrate_mono(kBoard, views_in_the_middle(truth, rng), kSize, LensKind::fisheye);
        ASSERT_TRUE(result) << result.error().message;
        for (const double u : {0.0, 0.25, 0.5, 0.75, 1.0}) {
            for (const double v : {0.0, 0.5, 1.0}) {
                const Eigen::Vector2d pixel(u * (kSize.width - 1), v * (kSize.height - 1));
                const auto ray = camera::unproject(truth.model, pixel);
                const auto seen = camera::project(result->camera.model, ray.value());
                ASSERT_TRUE(seen && camera::unproject(result->camera.model, pixel))
                    << "seed " << seed << ": no image at " << pixel.transpose();
                const auto covariance_px2 = mapping_covariance_px2(
                    LensKind::fisheye, result->parameters, result->covariance, *seen);
                ASSERT_TRUE(covariance_px2) << "seed " << seed << " at " << pixel.transpose();
                const Eigen::Vector2d error_px = *seen - pixel;
                EXPECT_LT(error_px.dot(covariance_px2->inverse() * error_px), kThreeSigma_sq)
                    << "seed " << seed << " at " << pixel.transpose();
            }
        }
    }
}

TEST(MonoCalibration, FewViewsDoNotLookBetterThanTheyAre) {
    // Four views use an eighth of their coordinates for poses and lens. Without this correction the
    // noise would look 6 % smaller.
    constexpr int kSeeds = 16;
    double square = 0.0;
    double freedom = 0.0;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        Rng rng(seed);
        const SyntheticViews views = pinhole_views(4, rng);
        CalibrationOptions lenient;
        lenient.most_focal_sigma = 1.0;
        const auto result = calibrate_mono(kBoard, views.left, kSize, LensKind::pinhole5, lenient);
        ASSERT_TRUE(result) << "seed " << seed << ": " << result.error().message;
        double points = 0.0;
        for (const ViewFit& view : result->views)
            points += static_cast<double>(view.camera.ids.size() - view.camera.outliers.size());
        const double own = 2.0 * points - 9.0 - 6.0 * static_cast<double>(result->views.size());
        square += own * result->sigma_px * result->sigma_px;
        freedom += own;
    }
    // Three standard deviations of a standard deviation.
    EXPECT_NEAR(std::sqrt(square / freedom), kNoise_px, 3.0 * kNoise_px / std::sqrt(2.0 * freedom));
}

TEST(MonoCalibration, SameInputGivesTheSameBytes) {
    Rng rng(7);
    const SyntheticViews views = pinhole_views(8, rng);
    const auto a = calibrate_mono(kBoard, views.left, kSize, LensKind::pinhole5);
    const auto b = calibrate_mono(kBoard, views.left, kSize, LensKind::pinhole5);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->parameters, b->parameters);
    EXPECT_EQ(a->covariance, b->covariance);
}

TEST(MonoCalibration, LeavesOutWhatDoesNotBelong) {
    Rng rng(8);
    SyntheticViews views = pinhole_views(14, rng);
    views.left[2].pixels[5].x() += 6.0;                                      // one bad corner
    views.left[4].pixels[0].y() = std::numeric_limits<double>::quiet_NaN();  //
    views.left[6].ids.resize(4);                                             // too few points
    views.left[6].pixels.resize(4);                                          //
    views.left[7] = {};                                                      // not found
    std::swap(views.left[8].pixels[3], views.left[8].pixels[17]);            // mixed up ids
    std::reverse(views.left[8].pixels.begin() + 5, views.left[8].pixels.end() - 5);
    views.left[9].ids.back() = 1000;  // not on the board
    views.left[10].ids.pop_back();    // ids without pixels
    views.left[12] = views.left[11];  // twice the same
    const auto result = calibrate_mono(kBoard, views.left, kSize, LensKind::pinhole5);
    ASSERT_TRUE(result) << result.error().message;
    std::vector<std::size_t> rejected;
    for (const RejectedView& view : result->rejected) {
        rejected.push_back(view.index);
        EXPECT_FALSE(view.reason.empty()) << view.index;
    }
    EXPECT_EQ(rejected, (std::vector<std::size_t>{4, 6, 7, 8, 9, 10, 12}));
    EXPECT_EQ(result->views[2].camera.outliers, std::vector<int>{views.left[2].ids[5]});
    EXPECT_NEAR(result->sigma_px, kNoise_px, 0.01);
}

/// The sheet bends along its rows, by `bow_m` between its ends and its middle.
BoardView bowed_view(const camera::Camera& camera,
                     const Pose& T_camera_board,
                     double bow_m,
                     Rng& rng) {
    const double half_m = 0.5 * kBoard.points_m().back().x();
    BoardView view = view_of(kBoard, camera, T_camera_board, 0.0, rng);
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
        Eigen::Vector3d point = kBoard.points_m()[static_cast<std::size_t>(view.ids[i])];
        const double from_middle = point.x() / half_m - 1.0;
        point.z() = bow_m * (1.0 - from_middle * from_middle);
        view.pixels[i] = camera::project(camera.model, T_camera_board * point).value() +
                         kNoise_px * Eigen::Vector2d(rng.normal(), rng.normal());
    }
    return view;
}

/// The rows of the lower half show the board after it moved: a rolling shutter, or two half images.
BoardView torn_view(const camera::Camera& camera, const Pose& T_camera_board, Rng& rng) {
    Pose moved = T_camera_board;
    moved.translation_m += Eigen::Vector3d(0.001, 0.0, 0.0);
    BoardView view = view_of(kBoard, camera, T_camera_board, kNoise_px, rng);
    const BoardView later = view_of(kBoard, camera, moved, kNoise_px, rng);
    for (std::size_t i = 0; i < std::min(view.ids.size(), later.ids.size()); ++i)
        if (view.ids[i] == later.ids[i] && view.ids[i] / kBoard.columns >= kBoard.rows / 2)
            view.pixels[i] = later.pixels[i];
    return view;
}

TEST(MonoCalibration, LeavesOutABoardThatBowsAndOneThatMoved) {
    const Case lens = cases()[1];
    const camera::Camera camera{model_of(lens.kind, lens.truth), kSize.width, kSize.height};
    Uncertainty uncertainty;
    for (const std::uint64_t seed : {31U, 32U, 33U}) {
        Rng rng(seed);
        SyntheticViews views = pinhole_views(12, rng);
        views.left[3] = bowed_view(camera, views.T_left_board[3], 0.003, rng);
        views.left[8] = torn_view(camera, views.T_left_board[8], rng);
        const auto result = calibrate_mono(kBoard, views.left, kSize, lens.kind);
        ASSERT_TRUE(result) << result.error().message;
        std::vector<std::size_t> rejected;
        for (const RejectedView& view : result->rejected) {
            rejected.push_back(view.index);
            EXPECT_NE(view.reason.find("this view contradicts the others"), std::string::npos)
                << view.reason;
        }
        EXPECT_EQ(rejected, (std::vector<std::size_t>{3, 8})) << "seed " << seed;
        uncertainty.add(result->parameters - lens.truth, result->covariance);
    }
    uncertainty.expect_true();
}

std::string refusal(std::span<const BoardView> views, ImageSize size = kSize) {
    const auto result = calibrate_mono(kBoard, views, size, LensKind::pinhole5);
    return result ? "" : result.error().message;
}

TEST(MonoCalibration, RefusesWhatDeterminesNothing) {
    EXPECT_NE(refusal({}).find("at least 3"), std::string::npos);
    Rng rng(9);
    const SyntheticViews views = pinhole_views(3, rng);
    EXPECT_NE(refusal(std::span(views.left).first(1)).find("at least 3"), std::string::npos);
    EXPECT_NE(refusal(views.left, {0, 0}).find("outside the 0x0 image"), std::string::npos);
    const std::vector<BoardView> copies(10, views.left[0]);
    EXPECT_NE(refusal(copies).find("the same as view 0"), std::string::npos);
}

TEST(MonoCalibration, SaysThatTiltIsMissing) {
    Rng rng(10);
    const camera::Camera camera{
        model_of(LensKind::pinhole5, cases()[1].truth), kSize.width, kSize.height};
    std::vector<BoardView> still;     // one pose, ten times
    std::vector<BoardView> parallel;  // moved, but never rotated
    for (int i = 0; i < 10; ++i) {
        const Pose tilted{exp_so3({0.4, 0.2, 0.0}), {-0.12, -0.08, 0.5}};
        still.push_back(view_of(kBoard, camera, tilted, 2.0 * kNoise_px, rng));
        Pose moved = tilted;
        moved.translation_m += Eigen::Vector3d(0.01 * (i - 5), 0.01 * (i % 3), 0.03 * i);
        parallel.push_back(view_of(kBoard, camera, moved, kNoise_px, rng));
    }
    for (const auto& views : {still, parallel}) {
        const std::string text = refusal(views);
        EXPECT_NE(text.find("deg in tilt"), std::string::npos) << text;
    }
}

}  // namespace
}  // namespace surefoot::calibration
