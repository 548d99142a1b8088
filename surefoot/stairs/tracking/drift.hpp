// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "surefoot/core/pose.hpp"

namespace surefoot::stairs {

/// Uncertainty of the motion since a feature was last seen: how far its remembered position may be
/// wrong relative to the machine. Variances in the axes of odom.
struct Drift {
    double horizontal_var_m2 = 0.0;  ///< largest variance of all horizontal directions
    double height_var_m2 = 0.0;
    double yaw_var_rad2 = 0.0;
    double tilt_var_rad2 = 0.0;  ///< the larger variance of the tilts about x and y

    /// Adds the uncertainty of the motion of one frame. `relative_covariance`: see MotionEstimate.
    void add(const Matrix6& relative_covariance, const Eigen::Matrix3d& R_odom_body);
    /// False if a variance is above (1 m)^2 or (1 rad)^2 or not finite: positions are then unknown.
    [[nodiscard]] bool is_bounded() const;

    /// Position variance at a distance from the machine. `level_var_m2` gives the height variance.
    [[nodiscard]] double place_var_m2(double distance_m) const {
        return horizontal_var_m2 + distance_m * distance_m * yaw_var_rad2;
    }
    [[nodiscard]] double level_var_m2(double distance_m) const {
        return height_var_m2 + distance_m * distance_m * tilt_var_rad2;
    }
};

}  // namespace surefoot::stairs
