// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>

#include "surefoot/core/result.hpp"

namespace surefoot::eval {

/// Plane through the points of a board in front of a camera: 1/z = (x/z, y/z, 1) .
/// inverse_depth_1_m. Disparity noise is symmetric in 1/z, so the fit has no bias.
struct BoardPlane {
    Eigen::Vector3d inverse_depth_1_m = Eigen::Vector3d::Zero();
    /// Depth [m] on the optical axis.
    [[nodiscard]] double distance_m() const { return 1.0 / inverse_depth_1_m.z(); }
    /// Depth [m] in the direction (x/z, y/z).
    [[nodiscard]] double depth_m(double x, double y) const {
        return 1.0 / inverse_depth_1_m.dot(Eigen::Vector3d(x, y, 1.0));
    }
};

/// Fits the plane by least squares; repeats without points beyond 4 sigma (from the median absolute
/// deviation). No value for fewer than 100 points, collinear points or a plane behind the camera.
[[nodiscard]] std::optional<BoardPlane> fit_board(std::span<const Eigen::Vector3d> points_m);

/// Errors of a stereo camera on a flat board across its optical axis.
struct BoardErrors {
    double axial_m = 0.0;  ///< distance of the fitted plane on the axis minus true distance
    double std_m = 0.0;    ///< rms distance in depth from the fitted plane, with outliers
    /// axial_m divided by the distance: the relative error of a length on the board due to its
    /// depth error. This is not an independent measurement: a textured board has no marks at known
    /// distances. A lens error across the image does not show in this value.
    double scale_share = 0.0;
    std::int64_t points = 0;
};
[[nodiscard]] std::optional<BoardErrors> board_errors(std::span<const Eigen::Vector3d> points_m,
                                                      double distance_m);

/// Combines measurements at one distance: mean of axial_m, rms of std_m, sum of points.
[[nodiscard]] BoardErrors mean_of(std::span<const BoardErrors> looks);

}  // namespace surefoot::eval
