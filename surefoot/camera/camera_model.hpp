// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <variant>

#include "surefoot/camera/kannala_brandt.hpp"
#include "surefoot/camera/pinhole_radtan.hpp"
#include "surefoot/camera/pinhole_rational.hpp"

namespace surefoot::camera {

using Matrix23 = Eigen::Matrix<double, 2, 3>;
using Matrix32 = Eigen::Matrix<double, 3, 2>;

/// Any of the lens models. Each offers
///   std::optional<Eigen::Vector2d> project(p_camera, Matrix23* d_pixel_d_point = nullptr) const
///   std::optional<Eigen::Vector3d> unproject(pixel, Matrix32* d_ray_d_pixel = nullptr) const
///   std::optional<std::string> problem() const
/// `project` fails if the model has no image of the point. `unproject` returns the unit ray, for
/// fisheye lenses also beyond 90 deg; it fails if no ray maps to the pixel.
using CameraModel = std::variant<PinholeRadTan, KannalaBrandt, PinholeRational>;

[[nodiscard]] std::optional<Eigen::Vector2d> project(const CameraModel& model,
                                                     const Eigen::Vector3d& p_camera,
                                                     Matrix23* d_pixel_d_point = nullptr);
[[nodiscard]] std::optional<Eigen::Vector3d> unproject(const CameraModel& model,
                                                       const Eigen::Vector2d& pixel,
                                                       Matrix32* d_ray_d_pixel = nullptr);

/// A lens with its image size. Pixel (0, 0) is the centre of the top left pixel.
struct Camera {
    CameraModel model;
    int width = 0;
    int height = 0;
    /// Returns the first problem of the image size or of the lens, or nullopt if there is none.
    [[nodiscard]] std::optional<std::string> problem() const;
};

}  // namespace surefoot::camera
