// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "surefoot/core/pose.hpp"

namespace surefoot::elevation {

/// Effect of an uncertain body motion on remembered ground (Fankhauser 2014, section 5; here as a
/// closed form per cell). r = (x, y, z) points from the body to a cell in odom axes. An error (dp,
/// theta) of the relative motion displaces the cell relative to the body by dp + theta x r:
///   dz = dp_z + theta_x y - theta_y x         (translation and tilt leverage)
///   dx = dp_x + theta_y z - theta_z y,  dy = dp_y + theta_z x - theta_x z      (yaw leverage)
class MotionNoise {
  public:
    /// `relative_covariance`: covariance (translation, rotation) of the motion since the previous
    /// update. It is a right perturbation in the present body frame; see pose.hpp.
    MotionNoise(const Matrix6& relative_covariance, const Eigen::Matrix3d& R_odom_body);

    /// True if all entries are finite. Otherwise the position of the cells is unknown.
    [[nodiscard]] bool is_finite() const { return covariance_.allFinite(); }
    /// True if all entries are so small that `blur_row` stays in the range of floats on every map.
    /// With larger entries, two infinities may cancel and the added variance may vanish.
    [[nodiscard]] bool is_bounded() const {
        return is_finite() && covariance_.cwiseAbs().maxCoeff() <= kMostVariance;
    }
    static constexpr double kMostVariance = 1e12;  ///< (1000 km)^2, (1e6 rad)^2
    [[nodiscard]] bool is_zero() const { return covariance_.isZero(0.0); }

    /// Returns the variance that the motion adds to the height of a cell, never negative.
    [[nodiscard]] double height_var_m2(double x_m, double y_m) const noexcept;
    /// Returns the horizontal variance in its worst direction: the larger eigenvalue of
    /// cov(dx, dy), never negative. The sum over several motions is an upper limit.
    [[nodiscard]] double horizontal_var_m2(double x_m, double y_m, double z_m) const noexcept;

    /// Cells of a row along x, from the body in odom axes.
    struct Row {
        double first_x_m = 0.0;
        double y_m = 0.0;
        double step_m = 0.0;
        double body_z_m = 0.0;  ///< height of the body in odom; z of a cell counts from it
    };
    /// Adds the motion's variances to those of remembered cells, in floats. The drift is a sigma.
    /// Every instruction set gives the same bytes. NaN stays NaN.
    void blur_row(const Row& row,
                  int cells,
                  const float* height_m,
                  float* height_var_m2,
                  float* horizontal_drift_m) const;

  private:
    Matrix6 covariance_;  ///< covariance of the motion in odom axes, about the body
};

}  // namespace surefoot::elevation
