// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <vector>

#include "studies/board_calibration/rendered_boards.hpp"
#include "surefoot/calibration/boards/board_print.hpp"
#include "surefoot/calibration/boards/detect_board.hpp"
#include "surefoot/calibration/lenses/lens_mapping.hpp"
#include "surefoot/calibration/mono_calibration.hpp"
#include "surefoot/calibration/stereo_calibration.hpp"
#include "surefoot/sim/rendering/board_renderer.hpp"

namespace surefoot::app::testing {

/// 99.73 % quantile of chi square with two degrees of freedom: three sigma.
inline constexpr double kThreeSigma_sq = 11.83;
/// 99.73 % quantile of chi square with six degrees of freedom.
inline constexpr double kThreeSigmaOfSix_sq = 20.06;
inline constexpr int kWidth_px = 320;
inline constexpr int kHeight_px = 240;

/// A wide lens of 320 x 240 px, times `scale`. No polynomial approximates its denominator.
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

/// A fisheye lens of nearly 180 deg.
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

/// A lens of 67 deg with the barrel distortion of common cameras; `with_k3` selects five
/// coefficients.
inline camera::Camera pinhole_camera(bool with_k3, int scale = 1) {
    return {camera::PinholeRadTan{.fx_px = 240.0 * scale,
                                  .fy_px = 240.4 * scale,
                                  .cx_px = 159.5 * scale - 0.5,
                                  .cy_px = 122.5 * scale - 0.5,
                                  .k1 = -0.28,
                                  .k2 = with_k3 ? 0.11 : 0.08,
                                  .p1 = 4e-4,
                                  .p2 = -2e-4,
                                  .k3 = with_k3 ? -0.02 : 0.0},
            kWidth_px * scale,
            kHeight_px * scale};
}

inline camera::Camera camera_of(calibration::LensKind kind, int scale = 1) {
    switch (kind) {
        case calibration::LensKind::pinhole4: return pinhole_camera(false, scale);
        case calibration::LensKind::pinhole5: return pinhole_camera(true, scale);
        case calibration::LensKind::rational: return rational_camera(scale);
        case calibration::LensKind::fisheye: return fisheye_camera(scale);
    }
    return {};
}

/// A rig of two such lenses, 60 mm apart and rotated slightly, more than in a carefully built rig.
inline camera::StereoRig rig_of(calibration::LensKind kind, int scale = 1) {
    camera::StereoRig rig;
    rig.left = camera_of(kind, scale);
    rig.right = camera_of(kind, scale);
    rig.T_left_right = {exp_so3({0.008, -0.012, 0.005}), {0.06, 0.0007, -0.0004}};
    return rig;
}

inline sim::ImagingConditions blurred_and_noisy() {
    sim::ImagingConditions observation;
    observation.blur_sigma_px = 0.7;
    observation.noise_dn = 2.0;
    return observation;
}

/// Boards detected in `count` rendered images with slight blur and noise.
inline std::vector<calibration::BoardView> seen_boards(const calibration::Board& board,
                                                       const camera::Camera& camera,
                                                       int count,
                                                       std::uint64_t pose_seed,
                                                       std::uint64_t noise_seed) {
    Rng rng(pose_seed);
    const BoardCamera this_camera{camera, Pose{}};
    const auto sheet = calibration::print_of(board);
    const sim::ImagingConditions observation = blurred_and_noisy();
    Serial serial;
    std::vector<calibration::BoardView> views;
    for (const Pose& T_camera_board : shown_poses(board, {&this_camera, 1}, count, rng)) {
        const GreyImage image =
            sim::render_board(*sheet, camera, T_camera_board, observation, noise_seed++, serial);
        views.push_back(calibration::detect_board(board, image.view()).view);
    }
    return views;
}

struct SeenPairs {
    std::vector<calibration::BoardView> left;
    std::vector<calibration::BoardView> right;
};

/// Boards detected in the images of both cameras of a rig.
inline SeenPairs seen_pairs(const calibration::Board& board,
                            const camera::StereoRig& rig,
                            int count,
                            std::uint64_t pose_seed,
                            std::uint64_t noise_seed) {
    Rng rng(pose_seed);
    const std::vector<BoardCamera> cameras = cameras_of(rig);
    const auto sheet = calibration::print_of(board);
    Serial serial;
    SeenPairs pairs;
    for (const Pose& T_left_board : shown_poses(board, cameras, count, rng)) {
        std::array<calibration::BoardView, 2> found;
        for (std::size_t this_camera = 0; this_camera < found.size(); ++this_camera) {
            const GreyImage image =
                sim::render_board(*sheet,
                                  cameras[this_camera].camera,
                                  cameras[this_camera].T_left_camera.inverse() * T_left_board,
                                  blurred_and_noisy(),
                                  noise_seed++,
                                  serial);
            found[this_camera] = calibration::detect_board(board, image.view()).view;
        }
        if (!found[0].ids.empty() && !found[1].ids.empty())
            found[1] = calibration::turned_like(board, found[0], found[1]);
        pairs.left.push_back(std::move(found[0]));
        pairs.right.push_back(std::move(found[1]));
    }
    return pairs;
}

/// Errors of the pose of the right camera, and the standard deviations that the calibration
/// reports: in the frame of the right camera, translation [m] before rotation [rad].
struct RigErrors {
    Vector6 errors = Vector6::Zero();
    Vector6 sigmas = Vector6::Zero();
    double baseline_m = 0.0;  ///< error of the length of the baseline
    double baseline_sigma_m = 0.0;
    double mahalanobis_sq = 0.0;  ///< squared Mahalanobis distance of all six errors
};

inline RigErrors rig_errors(const camera::StereoRig& truth,
                            const calibration::StereoCalibration& estimate) {
    const Eigen::Matrix<double, 6, 6> covariance =
        estimate.covariance.bottomRightCorner<6, 6>().eval();
    const Pose& found = estimate.rig.T_left_right;
    RigErrors result;
    result.errors = difference(truth.T_left_right, found);
    result.sigmas = covariance.diagonal().cwiseSqrt();
    // The perturbation moves the translation in the frame of the right camera.
    const Eigen::Vector3d along = found.R().transpose() * found.translation_m.normalized();
    result.baseline_m = found.translation_m.norm() - truth.T_left_right.translation_m.norm();
    result.baseline_sigma_m = std::sqrt(along.dot(covariance.topLeftCorner<3, 3>() * along));
    result.mahalanobis_sq = result.errors.dot(covariance.ldlt().solve(result.errors));
    return result;
}

/// Squared Mahalanobis distance of all parameters from the truth, by the covariance of the
/// calibration. Does not support rational lenses.
inline double parameter_chi_square(const camera::Camera& truth,
                                   const calibration::MonoCalibration& estimate) {
    Eigen::VectorXd error = estimate.parameters;
    if (const auto* f = std::get_if<camera::KannalaBrandt>(&truth.model)) {
        error -= Eigen::Vector<double, 8>(
            f->fx_px, f->fy_px, f->cx_px, f->cy_px, f->k1, f->k2, f->k3, f->k4);
    } else if (const auto* p = std::get_if<camera::PinholeRadTan>(&truth.model)) {
        error.head<8>() -= Eigen::Vector<double, 8>(
            p->fx_px, p->fy_px, p->cx_px, p->cy_px, p->k1, p->k2, p->p1, p->p2);
        if (error.size() > 8) error[8] -= p->k3;
    }
    const Eigen::VectorXd sigmas = estimate.covariance.diagonal().cwiseSqrt();
    const Eigen::VectorXd scaled = error.cwiseQuotient(sigmas);
    const Eigen::MatrixXd correlation = sigmas.cwiseInverse().asDiagonal() * estimate.covariance *
                                        sigmas.cwiseInverse().asDiagonal();
    return scaled.dot(correlation.ldlt().solve(scaled));
}

/// Errors of an estimated lens over the whole image: distance between a pixel and the projection of
/// its true direction by the estimate.
struct MappingErrors {
    std::vector<double> squares;  ///< squared distance, in standard deviations of the estimate
    std::vector<double> lengths_px;
    /// Pixels for which the estimate has no direction, or whose true direction it cannot project.
    std::vector<Eigen::Vector2d> without_image;
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
            if (!found || !camera::unproject(estimate.camera.model, pixel)) {
                errors.without_image.push_back(pixel);
                continue;
            }
            // Use the covariance at the projection of the true direction: far from the boards
            // `pixel` itself may have another direction in the estimate.
            const auto covariance_px2 = calibration::mapping_covariance_px2(
                estimate.kind, estimate.parameters, estimate.covariance, *found);
            if (!covariance_px2) {
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
