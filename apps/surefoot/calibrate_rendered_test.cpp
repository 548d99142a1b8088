// SPDX-License-Identifier: Apache-2.0
// From pictures of a board to the lens: the truth lies within three sigma, measured in the image,
// because coefficients can stand in for each other.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "apps/surefoot/rendered_boards.hpp"
#include "sim/board_renderer.hpp"
#include "surefoot/calibration/board_print.hpp"
#include "surefoot/calibration/detect_board.hpp"
#include "surefoot/calibration/lens_mapping.hpp"
#include "surefoot/calibration/mono_calibration.hpp"

namespace surefoot::app {
namespace {

constexpr int kViews = 10;
constexpr calibration::ImageSize kSize{320, 240};

/// Wide, and with a denominator that a polynomial cannot follow.
camera::Camera rational_camera() {
    return {camera::PinholeRational{.fx_px = 210.0,
                                    .fy_px = 210.5,
                                    .cx_px = 159.0,
                                    .cy_px = 122.0,
                                    .k1 = 0.51,
                                    .k2 = -0.6,
                                    .p1 = 4e-4,
                                    .p2 = -2e-4,
                                    .k3 = 0.3,
                                    .k4 = 0.8,
                                    .k5 = -0.6,
                                    .k6 = 0.35},
            kSize.width,
            kSize.height};
}

/// Of nearly 180 deg.
camera::Camera fisheye_camera() {
    return {camera::KannalaBrandt{.fx_px = 120.0,
                                  .fy_px = 120.3,
                                  .cx_px = 158.0,
                                  .cy_px = 122.0,
                                  .k1 = 0.0121,
                                  .k2 = 0.0056,
                                  .k3 = -0.0061,
                                  .k4 = 0.0005},
            kSize.width,
            kSize.height};
}

std::vector<calibration::BoardView> seen_boards(const calibration::Board& board,
                                                const camera::Camera& camera) {
    Rng rng(21);
    const BoardEye eye{camera, Pose{}};
    const auto sheet = calibration::print_of(board);
    sim::BoardLook look;
    look.blur_sigma_px = 0.7;
    look.noise_dn = 2.0;
    Serial serial;
    std::vector<calibration::BoardView> views;
    std::uint64_t seed = 1;
    for (const Pose& T_camera_board : shown_poses(board, {&eye, 1}, kViews, rng)) {
        const GreyImage image =
            sim::render_board(*sheet, camera, T_camera_board, look, seed++, serial);
        views.push_back(calibration::detect_board(board, image.view()).view);
    }
    return views;
}

/// Distance of the estimate from the truth in its own standard deviations, squared, all over the
/// image.
std::vector<double> squares(const camera::Camera& truth,
                            const calibration::MonoCalibration& estimate) {
    std::vector<double> result;
    for (double v = 10.0; v < truth.height; v += 20.0) {
        for (double u = 10.0; u < truth.width; u += 20.0) {
            const Eigen::Vector2d pixel(u, v);
            const auto ray = camera::unproject(truth.model, pixel);
            const auto found = camera::project(estimate.camera.model, ray.value());
            const auto covariance_px2 = calibration::mapping_covariance_px2(
                estimate.kind, estimate.parameters, estimate.covariance, pixel);
            if (!found || !covariance_px2) {
                ADD_FAILURE() << "no image at " << u << ", " << v;
                continue;
            }
            const Eigen::Vector2d error_px = *found - pixel;
            result.push_back(error_px.dot(covariance_px2->inverse() * error_px));
        }
    }
    return result;
}

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
    const camera::Camera truth =
        GetParam().lens == calibration::LensKind::fisheye ? fisheye_camera() : rational_camera();
    const auto estimate =
        calibration::calibrate_mono(board, seen_boards(board, truth), kSize, GetParam().lens);
    ASSERT_TRUE(estimate) << estimate.error().message;
    EXPECT_LT(estimate->sigma_px, 0.1);
    const std::vector<double> all = squares(truth, *estimate);
    double sum = 0.0;
    for (const double square : all) {
        sum += square;
        EXPECT_LT(square, 11.83) << "99.73 % of chi square with two degrees of freedom";
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
