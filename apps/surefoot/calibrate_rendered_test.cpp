// SPDX-License-Identifier: Apache-2.0
// From pictures of a board to the lens: the truth lies within three sigma, measured in the image,
// because coefficients can stand in for each other.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "apps/surefoot/rendered_calibration_for_test.hpp"

namespace surefoot::app {
namespace {

constexpr int kViews = 10;
constexpr std::uint64_t kPoseSeed = 21;
constexpr std::uint64_t kNoiseSeed = 1;

/// Squared errors of eight or nine parameters in their own covariance: 99.9 % of chi square lie
/// between. Nearer than pixels can be asked, whose errors go together so that few of them count
/// (their mean of 2 may be as low as 0.016): a sigma three times too large fails, or one half as
/// large as it should be.
constexpr double kLeastChiSquare = 0.71;
constexpr double kMostChiSquare = 29.7;
/// Of the rational lens, whose coefficients stand in for each other, only the pixels are asked.
constexpr double kLeastMeanSquare = 0.016;

using calibration::LensKind;

constexpr const char* kChessboard = "chessboard:8x5:0.03";
constexpr const char* kCircles = "circles:8x5:0.03";
constexpr const char* kStaggered = "asymmetric_circles:4x9:0.05";
constexpr const char* kCharuco = "charuco:8x5:0.03:0.022";

struct Case {
    const char* board;
    LensKind lens;
    int scale = 1;  ///< markers of ChArUco boards are read from 640 x 480 px on
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

class CalibrateRenderedRig : public ::testing::TestWithParam<LensKind> {};
INSTANTIATE_TEST_SUITE_P(Lenses,
                         CalibrateRenderedRig,
                         ::testing::Values(LensKind::pinhole4, LensKind::fisheye),
                         [](const auto& now) {
                             return calibration::kLensKindNames[static_cast<int>(now.param)];
                         });

/// The squares of the fisheye's boards are down to 4 px small: no good pair may leave for that.
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
