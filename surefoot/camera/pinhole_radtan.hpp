// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

namespace surefoot::camera {

/// Pinhole with radial-tangential distortion (Brown 1966, OpenCV's order k1 k2 p1 p2 k3):
///   x = X/Z, y = Y/Z, r2 = x^2 + y^2, radial = 1 + k1 r2 + k2 r2^2 + k3 r2^3
///   u = fx (x radial + 2 p1 x y + p2 (r2 + 2 x^2)) + cx
///   v = fy (y radial + p1 (r2 + 2 y^2) + 2 p2 x y) + cy
struct PinholeRadTan {
    double fx_px = 0.0;
    double fy_px = 0.0;
    double cx_px = 0.0;
    double cy_px = 0.0;
    double k1 = 0.0;
    double k2 = 0.0;
    double p1 = 0.0;
    double p2 = 0.0;
    double k3 = 0.0;

    [[nodiscard]] bool has_distortion() const noexcept {
        return k1 != 0.0 || k2 != 0.0 || p1 != 0.0 || p2 != 0.0 || k3 != 0.0;
    }
    /// Returns nullopt for points at or behind the camera plane, and where the image folds back.
    [[nodiscard]] std::optional<Eigen::Vector2d> project(
        const Eigen::Vector3d& p_camera,
        Eigen::Matrix<double, 2, 3>* d_pixel_d_point = nullptr) const;
    /// Returns the unit ray (Newton on the distortion), or nullopt without convergence.
    [[nodiscard]] std::optional<Eigen::Vector3d> unproject(
        const Eigen::Vector2d& pixel, Eigen::Matrix<double, 3, 2>* d_ray_d_pixel = nullptr) const;
    [[nodiscard]] std::optional<std::string> problem() const;
};

}  // namespace surefoot::camera
