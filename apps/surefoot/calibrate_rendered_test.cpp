// SPDX-License-Identifier: Apache-2.0
// From pictures of a board to the lens: the truth lies within three sigma, measured in the image,
// because coefficients can stand in for each other.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "apps/surefoot/rendered_calibration_for_test.hpp"

namespace surefoot::app {
namespace {

constexpr int kViews = 10;
constexpr calibration::ImageSize kSize{testing::kWidth_px, testing::kHeight_px};
constexpr std::uint64_t kPoseSeed = 21;
constexpr std::uint64_t kNoiseSeed = 1;

struct Case {
    const char* board;
    calibration::LensKind lens;
};

class CalibrateRendered : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    Boards,
    CalibrateRendered,
    ::testing::Values(Case{"chessboard:8x5:0.03", calibration::LensKind::rational},
                      Case{"circles:8x5:0.03", calibration::LensKind::rational},
                      Case{"chessboard:8x5:0.03", calibration::LensKind::fisheye},
                      Case{"circles:8x5:0.03", calibration::LensKind::fisheye},
                      Case{"asymmetric_circles:4x9:0.05", calibration::LensKind::fisheye}));

TEST_P(CalibrateRendered, TheLensIsTrueWithinThreeSigmaAllOverTheImage) {
    const calibration::Board board = calibration::parse_board(GetParam().board).value();
    const camera::Camera truth = testing::camera_of(GetParam().lens);
    const auto views = testing::seen_boards(board, truth, kViews, kPoseSeed, kNoiseSeed);
    const auto estimate = calibration::calibrate_mono(board, views, kSize, GetParam().lens);
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
        estimate->kind, estimate->parameters, estimate->covariance, kSize);
    fmt::print("{}: noise {:.3f} px, image +- {:.3f} px (median), mean square {:.1f} of 2\n",
               GetParam().board,
               estimate->sigma_px,
               sigmas.median_px,
               sum / static_cast<double>(all.size()));
    EXPECT_LT(sigmas.median_px, 0.5) << "boards in ten places tell most of the image";
    EXPECT_GT(sum / static_cast<double>(all.size()), 0.2) << "or sigma is far too large";
}

}  // namespace
}  // namespace surefoot::app
