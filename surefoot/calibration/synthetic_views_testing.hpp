// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <optional>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/rng.hpp"

/// Views of a board with known truth, for the tests of this folder.
namespace surefoot::calibration::testing {

struct SyntheticViews {
    std::vector<BoardView> left;
    std::vector<BoardView> right;    ///< empty without a right camera
    std::vector<Pose> T_left_board;  ///< truth
};

/// `noise_px` per coordinate; the view contains no points outside the image.
inline BoardView view_of(const Board& board,
                         const camera::Camera& camera,
                         const Pose& T_camera_board,
                         double noise_px,
                         Rng& rng) {
    BoardView view;
    const std::vector<Eigen::Vector3d> points = board.points_m();
    for (std::size_t i = 0; i < points.size(); ++i) {
        auto pixel = camera::project(camera.model, T_camera_board * points[i]);
        if (!pixel) continue;
        pixel->x() += noise_px * rng.normal();
        pixel->y() += noise_px * rng.normal();
        if (pixel->x() < 0.0 || pixel->y() < 0.0 || pixel->x() > camera.width - 1 ||
            pixel->y() > camera.height - 1) {
            continue;
        }
        view.ids.push_back(static_cast<int>(i));
        view.pixels.push_back(*pixel);
    }
    return view;
}

/// The board's middle lies on the ray of a random pixel, 0.25 to 0.6 m away. The board faces the
/// camera, up to a rotation by `tilt_rad` about a random axis.
inline Pose random_pose(const Board& board, const camera::Camera& left, double tilt_rad, Rng& rng) {
    std::optional<Eigen::Vector3d> ray;
    while (!ray)
        ray = camera::unproject(
            left.model,
            {rng.uniform(0.15, 0.85) * left.width, rng.uniform(0.15, 0.85) * left.height});
    const double turn = rng.uniform(-3.0, 3.0);
    const Eigen::Vector3d axis(std::cos(turn), std::sin(turn), 0.3 * rng.normal());
    const Eigen::Quaterniond facing =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), *ray);
    Pose T;
    T.rotation = (facing * exp_so3(rng.uniform(0.2, 1.0) * tilt_rad * axis)).normalized();
    const Eigen::Vector3d middle = 0.5 * (board.points_m().front() + board.points_m().back());
    T.translation_m = rng.uniform(0.25, 0.6) * *ray - T.rotation * middle;
    return T;
}

/// Every view shows at least half of the board in each camera.
inline SyntheticViews synthetic_views(const Board& board,
                                      const camera::StereoRig& rig,
                                      int count,
                                      double noise_px,
                                      Rng& rng,
                                      double tilt_rad = 0.7) {
    const std::size_t least = board.points_m().size() / 2;
    SyntheticViews views;
    while (static_cast<int>(views.left.size()) < count) {
        const Pose T_left_board = random_pose(board, rig.left, tilt_rad, rng);
        BoardView left = view_of(board, rig.left, T_left_board, noise_px, rng);
        if (left.ids.size() < least) continue;
        if (rig.right) {
            BoardView right = view_of(
                board, *rig.right, rig.T_left_right.inverse() * T_left_board, noise_px, rng);
            if (right.ids.size() < least) continue;
            views.right.push_back(std::move(right));
        }
        views.left.push_back(std::move(left));
        views.T_left_board.push_back(T_left_board);
    }
    return views;
}

/// Compares the errors of several calibrations with their stated covariances.
class Uncertainty {
  public:
    void add(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
        const Eigen::VectorXd sigma = covariance.diagonal().cwiseSqrt();
        const Eigen::MatrixXd correlation =
            sigma.cwiseInverse().asDiagonal() * covariance * sigma.cwiseInverse().asDiagonal();
        const Eigen::VectorXd scaled = error.cwiseQuotient(sigma);
        beyond_three_sigma_ += static_cast<int>((scaled.array().abs() > 3.0).count());
        chi_square_ += scaled.dot(correlation.ldlt().solve(scaled));
        values_ += static_cast<double>(error.size());
    }
    /// The sum of squared errors over their covariance is chi square with one degree of freedom per
    /// value. The limit is 3.3 standard deviations (99.9 %).
    void expect_true() const {
        EXPECT_NEAR(chi_square_, values_, 3.3 * std::sqrt(2.0 * values_));
        EXPECT_LE(beyond_three_sigma_, 1) << "of " << values_ << " values; 0.3 % are expected";
    }

  private:
    double chi_square_ = 0.0;
    double values_ = 0.0;
    int beyond_three_sigma_ = 0;
};

}  // namespace surefoot::calibration::testing
