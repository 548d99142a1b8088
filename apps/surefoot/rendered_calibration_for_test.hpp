// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/LU>
#include <vector>

#include "apps/surefoot/rendered_boards.hpp"
#include "sim/board_renderer.hpp"
#include "surefoot/calibration/board_print.hpp"
#include "surefoot/calibration/detect_board.hpp"
#include "surefoot/calibration/lens_mapping.hpp"
#include "surefoot/calibration/mono_calibration.hpp"

namespace surefoot::app::testing {

/// 99.73 % of chi square with two degrees of freedom: three sigma.
inline constexpr double kThreeSigma_sq = 11.83;
inline constexpr int kWidth_px = 320;
inline constexpr int kHeight_px = 240;

/// Of 320 x 240 px, `scale` times finer: wide, and with a denominator that no polynomial follows.
inline camera::Camera rational_camera(int scale = 1) {
    return {camera::PinholeRational{.fx_px = 210.0 * scale,
                                    .fy_px = 210.5 * scale,
                                    .cx_px = 159.5 * scale - 0.5,
                                    .cy_px = 122.5 * scale - 0.5,
                                    .k1 = 0.51,
                                    .k2 = -0.6,
                                    .p1 = 4e-4,
                                    .p2 = -2e-4,
                                    .k3 = 0.3,
                                    .k4 = 0.8,
                                    .k5 = -0.6,
                                    .k6 = 0.35},
            kWidth_px * scale,
            kHeight_px * scale};
}

/// The same of nearly 180 deg.
inline camera::Camera fisheye_camera(int scale = 1) {
    return {camera::KannalaBrandt{.fx_px = 120.0 * scale,
                                  .fy_px = 120.3 * scale,
                                  .cx_px = 158.5 * scale - 0.5,
                                  .cy_px = 122.5 * scale - 0.5,
                                  .k1 = 0.0121,
                                  .k2 = 0.0056,
                                  .k3 = -0.0061,
                                  .k4 = 0.0005},
            kWidth_px * scale,
            kHeight_px * scale};
}

inline camera::Camera camera_of(calibration::LensKind kind, int scale = 1) {
    return kind == calibration::LensKind::fisheye ? fisheye_camera(scale) : rational_camera(scale);
}

/// What is found in pictures of a board, somewhat blurred and noisy.
inline std::vector<calibration::BoardView> seen_boards(const calibration::Board& board,
                                                       const camera::Camera& camera,
                                                       int count,
                                                       std::uint64_t pose_seed,
                                                       std::uint64_t noise_seed) {
    Rng rng(pose_seed);
    const BoardEye eye{camera, Pose{}};
    const auto sheet = calibration::print_of(board);
    sim::BoardLook look;
    look.blur_sigma_px = 0.7;
    look.noise_dn = 2.0;
    Serial serial;
    std::vector<calibration::BoardView> views;
    for (const Pose& T_camera_board : shown_poses(board, {&eye, 1}, count, rng)) {
        const GreyImage image =
            sim::render_board(*sheet, camera, T_camera_board, look, noise_seed++, serial);
        views.push_back(calibration::detect_board(board, image.view()).view);
    }
    return views;
}

/// An estimate beside the truth, all over the image.
struct MappingErrors {
    std::vector<double> squares;  ///< of the distance in the estimate's own standard deviations
    std::vector<double> lengths_px;
    std::vector<Eigen::Vector2d> without_image;  ///< pixels that the estimate cannot see
};

inline MappingErrors mapping_errors(const camera::Camera& truth,
                                    const calibration::MonoCalibration& estimate) {
    MappingErrors errors;
    const double step_px = truth.width / 16.0;
    for (double v = 0.5 * step_px; v < truth.height; v += step_px) {
        for (double u = 0.5 * step_px; u < truth.width; u += step_px) {
            const Eigen::Vector2d pixel(u, v);
            const auto ray = camera::unproject(truth.model, pixel);
            const auto found = camera::project(estimate.camera.model, ray.value());
            const auto covariance_px2 = calibration::mapping_covariance_px2(
                estimate.kind, estimate.parameters, estimate.covariance, pixel);
            if (!found || !covariance_px2) {
                errors.without_image.push_back(pixel);
                continue;
            }
            const Eigen::Vector2d error_px = *found - pixel;
            errors.squares.push_back(error_px.dot(covariance_px2->inverse() * error_px));
            errors.lengths_px.push_back(error_px.norm());
        }
    }
    return errors;
}

}  // namespace surefoot::app::testing
