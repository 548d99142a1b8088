// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

namespace surefoot::camera {

/// Fisheye of Kannala and Brandt 2006, four coefficients (OpenCV fisheye, Kalibr "equidistant"):
///   theta = angle from the optical axis, r = sqrt(X^2 + Y^2)
///   d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)
///   u = fx d X/r + cx, v = fy d Y/r + cy
struct KannalaBrandt {
    double fx_px = 0.0;
    double fy_px = 0.0;
    double cx_px = 0.0;
    double cy_px = 0.0;
    double k1 = 0.0;
    double k2 = 0.0;
    double k3 = 0.0;
    double k4 = 0.0;

    /// Returns nullopt where d stops growing with theta (outside the lens), and at the origin.
    [[nodiscard]] std::optional<Eigen::Vector2d> project(
        const Eigen::Vector3d& p_camera,
        Eigen::Matrix<double, 2, 3>* d_pixel_d_point = nullptr) const;
    /// Returns the unit ray (Newton on theta), or nullopt if no angle maps to the pixel.
    [[nodiscard]] std::optional<Eigen::Vector3d> unproject(
        const Eigen::Vector2d& pixel, Eigen::Matrix<double, 3, 2>* d_ray_d_pixel = nullptr) const;
    [[nodiscard]] std::optional<std::string> problem() const;
};

}  // namespace surefoot::camera
