// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "surefoot/core/pose.hpp"

namespace surefoot::stairs {

/// How far remembered things may have moved against the machine: variances of its unseen motion, in
/// the axes of odom.
struct Drift {
    double horizontal_var_m2 = 0.0;  ///< in its worst direction
    double height_var_m2 = 0.0;
    double yaw_var_rad2 = 0.0;
    double tilt_var_rad2 = 0.0;  ///< about the worse of x and y

    /// The motion of one more frame. `relative_covariance`: see MotionEstimate.
    void add(const Matrix6& relative_covariance, const Eigen::Matrix3d& R_odom_body);
    /// False: nothing is known of where things are.
    [[nodiscard]] bool is_bounded() const;

    /// Of a place so far from the machine.
    [[nodiscard]] double place_var_m2(double distance_m) const {
        return horizontal_var_m2 + distance_m * distance_m * yaw_var_rad2;
    }
    [[nodiscard]] double level_var_m2(double distance_m) const {
        return height_var_m2 + distance_m * distance_m * tilt_var_rad2;
    }
};

}  // namespace surefoot::stairs
