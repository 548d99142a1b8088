// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/tracking/drift.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::stairs {
namespace {

/// Returns the larger eigenvalue of the upper left 2 x 2 part of a symmetric matrix.
double worst_of(const Eigen::Matrix3d& c) {
    const double half_difference = 0.5 * (c(0, 0) - c(1, 1));
    return 0.5 * (c(0, 0) + c(1, 1)) + std::hypot(half_difference, c(0, 1));
}

}  // namespace

void Drift::add(const Matrix6& relative_covariance, const Eigen::Matrix3d& R_odom_body) {
    const Eigen::Matrix3d translation =
        R_odom_body * relative_covariance.topLeftCorner<3, 3>() * R_odom_body.transpose();
    const Eigen::Matrix3d rotation =
        R_odom_body * relative_covariance.bottomRightCorner<3, 3>() * R_odom_body.transpose();
    horizontal_var_m2 += worst_of(translation);
    height_var_m2 += translation(2, 2);
    yaw_var_rad2 += rotation(2, 2);
    tilt_var_rad2 += worst_of(rotation);
}

bool Drift::is_bounded() const {
    constexpr double kMost = 1.0;  // (1 m)^2, (1 rad)^2; with more, edges are ambiguous
    const double most =
        std::max(std::max(horizontal_var_m2, height_var_m2), std::max(yaw_var_rad2, tilt_var_rad2));
    // std::max may drop a NaN, so test the sum.
    return std::isfinite(horizontal_var_m2 + height_var_m2 + yaw_var_rad2 + tilt_var_rad2) &&
           most <= kMost;
}

}  // namespace surefoot::stairs
