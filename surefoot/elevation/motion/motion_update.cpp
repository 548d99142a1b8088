// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/motion/motion_update.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/elevation/motion/motion_rows.hpp"

namespace surefoot::elevation {
namespace {

// Indices in the covariance.
constexpr int kX = 0;
constexpr int kY = 1;
constexpr int kZ = 2;
constexpr int kRoll = 3;
constexpr int kPitch = 4;
constexpr int kYaw = 5;

}  // namespace

MotionNoise::MotionNoise(const Matrix6& relative_covariance, const Eigen::Matrix3d& R_odom_body) {
    Matrix6 J = Matrix6::Zero();
    J.topLeftCorner<3, 3>() = R_odom_body;
    J.bottomRightCorner<3, 3>() = R_odom_body;
    covariance_ = J * relative_covariance * J.transpose();
}

double MotionNoise::height_var_m2(double x_m, double y_m) const noexcept {
    const Matrix6& c = covariance_;
    const double var_m2 =
        c(kZ, kZ) + y_m * y_m * c(kRoll, kRoll) + x_m * x_m * c(kPitch, kPitch) +
        2.0 * (y_m * c(kZ, kRoll) - x_m * c(kZ, kPitch) - x_m * y_m * c(kRoll, kPitch));
    return std::max(0.0, var_m2);
}

double MotionNoise::horizontal_var_m2(double x_m, double y_m, double z_m) const noexcept {
    const Matrix6& c = covariance_;
    const double var_x =
        c(kX, kX) + z_m * z_m * c(kPitch, kPitch) + y_m * y_m * c(kYaw, kYaw) +
        2.0 * (z_m * c(kX, kPitch) - y_m * c(kX, kYaw) - y_m * z_m * c(kPitch, kYaw));
    const double var_y =
        c(kY, kY) + x_m * x_m * c(kYaw, kYaw) + z_m * z_m * c(kRoll, kRoll) +
        2.0 * (x_m * c(kY, kYaw) - z_m * c(kY, kRoll) - x_m * z_m * c(kRoll, kYaw));
    const double cov_xy = c(kX, kY) + x_m * c(kX, kYaw) - z_m * c(kX, kRoll) +
                          z_m * (c(kY, kPitch) + x_m * c(kPitch, kYaw) - z_m * c(kRoll, kPitch)) -
                          y_m * (c(kY, kYaw) + x_m * c(kYaw, kYaw) - z_m * c(kRoll, kYaw));
    const double half_difference = 0.5 * (var_x - var_y);
    const double larger =
        0.5 * (var_x + var_y) + std::sqrt(half_difference * half_difference + cov_xy * cov_xy);
    return std::max(0.0, larger);
}

void MotionNoise::blur_row(const Row& row,
                           int cells,
                           const float* height_m,
                           float* height_var_m2,
                           float* horizontal_drift_m) const {
    const Matrix6& c = covariance_;
    const double y = row.y_m;
    const auto f = [](double value) { return static_cast<float>(value); };
    const MotionPolynomials p{{f(c(kZ, kZ) + y * y * c(kRoll, kRoll) + 2.0 * y * c(kZ, kRoll)),
                               f(-2.0 * (c(kZ, kPitch) + y * c(kRoll, kPitch))),
                               f(c(kPitch, kPitch))},
                              {f(c(kX, kX) + y * y * c(kYaw, kYaw) - 2.0 * y * c(kX, kYaw)),
                               f(2.0 * (c(kX, kPitch) - y * c(kPitch, kYaw))),
                               f(c(kPitch, kPitch))},
                              {f(c(kY, kY)),
                               f(2.0 * c(kY, kYaw)),
                               f(-2.0 * c(kY, kRoll)),
                               f(c(kYaw, kYaw)),
                               f(-2.0 * c(kRoll, kYaw)),
                               f(c(kRoll, kRoll))},
                              {f(c(kX, kY) - y * c(kY, kYaw)),
                               f(c(kX, kYaw) - y * c(kYaw, kYaw)),
                               f(c(kY, kPitch) - c(kX, kRoll) + y * c(kRoll, kYaw)),
                               f(c(kPitch, kYaw)),
                               f(-c(kRoll, kPitch))},
                              f(row.first_x_m),
                              f(row.step_m),
                              f(row.body_z_m)};
    blur_cells(p, cells, height_m, height_var_m2, horizontal_drift_m);
}

}  // namespace surefoot::elevation
