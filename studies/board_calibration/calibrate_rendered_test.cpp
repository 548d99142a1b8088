// SPDX-License-Identifier: Apache-2.0
// Calibration of a lens from rendered images of a board. The true lens must lie within three sigma.
// The error is measured in the image, because different coefficients can describe the same mapping.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "studies/board_calibration/rendered_calibration_testing.hpp"

namespace surefoot::app {
namespace {

constexpr int kViews = 10;
constexpr std::uint64_t kPoseSeed = 21;
constexpr std::uint64_t kNoiseSeed = 1;

/// Bounds for the squared Mahalanobis distance of eight or nine parameters; 99.9 % of the
/// chi-square distribution lies between them. A sigma three times too large fails this test, and so
/// does one half as large as it should be. A test of pixel errors is weaker: they are correlated,
/// so few of them are independent, and their mean square (expected value 2) may be as low as 0.016.
constexpr double kLeastChiSquare = 0.71;
constexpr double kMostChiSquare = 29.7;
/// The rational lens is tested by pixel errors only, because its coefficients can compensate each
/// other.
constexpr double kLeastMeanSquare = 0.016;

using calibration::LensKind;

constexpr const char* kChessboard = "chessboard:8x5:0.03";
constexpr const char* kCircles = "circles:8x5:0.03";
constexpr const char* kStaggered = "asymmetric_circles:4x9:0.05";
constexpr const char* kCharuco = "charuco:8x5:0.03:0.022";

struct Case {
    const char* board;
    LensKind lens;
    int scale = 1;  ///< scale of the image; ChArUco markers need at least 640 x 480 px
};

class CalibrateRendered : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Boards,
                         CalibrateRendered,
                         ::testing::Values(Case{kChessboard, LensKind::pinhole4},
                                           Case{kChessboard, LensKind::pinhole5},
                                           Case{kChessboard, LensKind::rational},
                                           Case{kChessboard, LensKind::fisheye},
                                           Case{kCircles, LensKind::pinhole4},
                                           Case{kCircles, LensKind::rational},
                                           Case{kCircles, LensKind::fisheye},
                                           Case{kStaggered, LensKind::rational},
                                           Case{kStaggered, LensKind::fisheye},
                                           Case{kCharuco, LensKind::pinhole5, 2},
                                           Case{kCharuco, LensKind::rational, 2},
                                           Case{kCharuco, LensKind::fisheye, 2}),
                         [](const auto& now) {
                             const std::string board = now.param.board;
                             return board.substr(0, board.find(':')) + "_" +
                                    calibration::kLensKindNames[static_cast<int>(now.param.lens)];
                         });

TEST_P(CalibrateRendered, TheLensIsTrueWithinThreeSigmaAllOverTheImage) {
    const calibration::Board board = calibration::parse_board(GetParam().board).value();
    const camera::Camera truth = testing::camera_of(GetParam().lens, GetParam().scale);
    const calibration::ImageSize size{truth.width, truth.height};
    const auto views = testing::seen_boards(board, truth, kViews, kPoseSeed, kNoiseSeed);
    const auto estimate = calibration::calibrate_mono(board, views, size, GetParam().lens);
    ASSERT_TRUE(estimate) << estimate.error().message;
    EXPECT_LT(estimate->sigma_px, 0.1);
    const testing::MappingErrors errors = testing::mapping_errors(truth, *estimate);
    for (const Eigen::Vector2d& pixel : errors.without_image)
        ADD_FAILURE() << "no image at " << pixel.x() << ", " << pixel.y();
    const std::vector<double>& all = errors.squares;
    ASSERT_FALSE(all.empty());
    double sum = 0.0;
    for (const double square : all) {
        sum += square;
        EXPECT_LT(square, testing::kThreeSigma_sq);
    }
    const auto sigmas = calibration::mapping_sigmas_px(
        estimate->kind, estimate->parameters, estimate->covariance, size);
    fmt::print("{}: noise {:.3f} px, image +- {:.3f} px (median), mean square {:.1f} of 2\n",
               GetParam().board,
               estimate->sigma_px,
               sigmas.median_px,
               sum / static_cast<double>(all.size()));
    EXPECT_LT(sigmas.median_px, 0.5 * GetParam().scale) << "ten places tell most of the image";
    EXPECT_GT(sum / static_cast<double>(all.size()), kLeastMeanSquare)
        << "or sigma is far too large";
    if (GetParam().lens == LensKind::rational) return;
    const double chi_square = testing::parameter_chi_square(truth, *estimate);
    EXPECT_GT(chi_square, kLeastChiSquare) << "sigma is too large";
    EXPECT_LT(chi_square, kMostChiSquare) << "sigma is too small";
}

/// Image of a board that moves by `motion_m` while the shutter is open and is at `T_camera_board`
/// in the middle of the exposure. It is the mean of images rendered at equal intervals.
GreyImage moving_board(const calibration::Board& board,
                       const camera::Camera& camera,
                       const Pose& T_camera_board,
                       const Eigen::Vector3d& motion_m) {
    constexpr int kMoments = 16;
    const auto sheet = calibration::print_of(board);
    Serial serial;
    std::vector<double> sums(static_cast<std::size_t>(camera.width * camera.height), 0.0);
    for (int i = 0; i < kMoments; ++i) {
        Pose moved = T_camera_board;
        moved.translation_m += ((i + 0.5) / kMoments - 0.5) * motion_m;
        const GreyImage moment = sim::render_board(*sheet,
                                                   camera,
                                                   moved,
                                                   testing::blurred_and_noisy(),
                                                   kNoiseSeed + static_cast<std::uint64_t>(i),
                                                   serial);
        for (int v = 0; v < camera.height; ++v)
            for (int u = 0; u < camera.width; ++u)
                sums[static_cast<std::size_t>(v * camera.width + u)] += moment.row(v)[u];
    }
    GreyImage image(camera.width, camera.height);
    for (int v = 0; v < camera.height; ++v)
        for (int u = 0; u < camera.width; ++u)
            image.row(v)[u] = static_cast<std::uint8_t>(
                std::lround(sums[static_cast<std::size_t>(v * camera.width + u)] / kMoments));
    return image;
}

/// Two of ten boards move by this many pixels while the shutter is open.
class CalibrateMoving : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Pixels, CalibrateMoving, ::testing::Values(5, 10, 14, 20));

TEST_P(CalibrateMoving, BlurredViewsLeaveOrDoNoHarm) {
    const calibration::Board board = calibration::parse_board(kChessboard).value();
    const camera::Camera truth = testing::camera_of(LensKind::pinhole4);
    auto views = testing::seen_boards(board, truth, kViews, kPoseSeed, kNoiseSeed);
    Rng rng(kPoseSeed);
    const BoardCamera this_camera{truth, Pose{}};
    const std::vector<Pose> poses = shown_poses(board, {&this_camera, 1}, kViews, rng);
    const double focal_px = std::get<camera::PinholeRadTan>(truth.model).fx_px;
    for (const std::size_t i : {3U, 7U}) {
        const double m_per_px = poses[i].translation_m.z() / focal_px;
        const Eigen::Vector3d motion_m = GetParam() * m_per_px * Eigen::Vector3d(0.8, 0.6, 0.0);
        const GreyImage image = moving_board(board, truth, poses[i], motion_m);
        const auto sighting = calibration::detect_board(board, image.view());
        views[i] = sighting.view;
        double worst_px = 0.0;
        for (std::size_t k = 0; k < views[i].ids.size(); ++k) {
            const Eigen::Vector3d p_m =
                poses[i] * board.points_m()[static_cast<std::size_t>(views[i].ids[k])];
            worst_px = std::max(worst_px,
                                (views[i].pixels[k] - *camera::project(truth.model, p_m)).norm());
        }
        EXPECT_LE(worst_px, 0.02 * GetParam())
            << "honest, or none: " << views[i].ids.size() << " corners";
        fmt::print("view {}: {} corners, largest error {:.3f} px {}\n",
                   i,
                   views[i].ids.size(),
                   worst_px,
                   sighting.problem);
    }
    const auto estimate =
        calibration::calibrate_mono(board, views, {truth.width, truth.height}, LensKind::pinhole4);
    ASSERT_TRUE(estimate) << estimate.error().message;
    for (const auto& left_out : estimate->rejected)
        fmt::print("view {} left: {}\n", left_out.index, left_out.reason);
    EXPECT_GE(estimate->views.size(), static_cast<std::size_t>(kViews - 2));
    for (const double square : testing::mapping_errors(truth, *estimate).squares)
        EXPECT_LT(square, testing::kThreeSigma_sq);
    const double chi_square = testing::parameter_chi_square(truth, *estimate);
    fmt::print("noise {:.4f} px, chi square {:.1f}\n", estimate->sigma_px, chi_square);
    EXPECT_GT(chi_square, kLeastChiSquare) << "sigma is too large";
    EXPECT_LT(chi_square, kMostChiSquare) << "sigma is too small";
}

class CalibrateRenderedRig : public ::testing::TestWithParam<LensKind> {};
INSTANTIATE_TEST_SUITE_P(Lenses,
                         CalibrateRenderedRig,
                         ::testing::Values(LensKind::pinhole4, LensKind::fisheye),
                         [](const auto& now) {
                             return calibration::kLensKindNames[static_cast<int>(now.param)];
                         });

/// Board squares are as small as 4 px in the fisheye images. No good pair may be rejected for that.
TEST_P(CalibrateRenderedRig, TheRightEyeIsWhereItIsSaidWithinThreeSigma) {
    const calibration::Board board = calibration::parse_board(kChessboard).value();
    const camera::StereoRig truth = testing::rig_of(GetParam());
    const auto pairs = testing::seen_pairs(board, truth, kViews, kPoseSeed, kNoiseSeed);
    const auto estimate = calibration::calibrate_stereo(
        board, pairs.left, pairs.right, {truth.left.width, truth.left.height}, GetParam());
    ASSERT_TRUE(estimate) << estimate.error().message;
    EXPECT_GE(estimate->pairs.size(), static_cast<std::size_t>(kViews - 2));
    for (const calibration::RejectedView& pair : estimate->rejected)
        EXPECT_NE(pair.reason.find("not found"), std::string::npos) << pair.reason;
    const testing::RigErrors errors = testing::rig_errors(truth, *estimate);
    fmt::print("baseline {:+.3f} of sigma {:.3f} mm, squared distance {:.1f} of 6\n",
               1e3 * errors.baseline_m,
               1e3 * errors.baseline_sigma_m,
               errors.mahalanobis_sq);
    EXPECT_LT(std::abs(errors.baseline_m), 3.0 * errors.baseline_sigma_m);
    for (int i = 0; i < 6; ++i) EXPECT_LT(std::abs(errors.errors[i]), 3.0 * errors.sigmas[i]) << i;
    EXPECT_LT(errors.mahalanobis_sq, testing::kThreeSigmaOfSix_sq);
    EXPECT_LT(errors.baseline_sigma_m, 1e-4) << "or sigma is far too large";
}

}  // namespace
}  // namespace surefoot::app
