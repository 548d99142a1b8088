// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/camera_model.hpp"

#include <fmt/format.h>

#include "surefoot/camera/rig_units.hpp"

namespace surefoot::camera {
namespace {

/// Largest valid image side [px]. A larger side is a mistake in the file.
constexpr int kMaxSide_px = 16384;

}  // namespace

std::optional<Eigen::Vector2d> project(const CameraModel& model,
                                       const Eigen::Vector3d& p_camera,
                                       Matrix23* d_pixel_d_point) {
    return std::visit([&](const auto& m) { return m.project(p_camera, d_pixel_d_point); }, model);
}

std::optional<Eigen::Vector3d> unproject(const CameraModel& model,
                                         const Eigen::Vector2d& pixel,
                                         Matrix32* d_ray_d_pixel) {
    return std::visit([&](const auto& m) { return m.unproject(pixel, d_ray_d_pixel); }, model);
}

std::optional<std::string> Camera::problem() const {
    if (width < 2 || height < 2 || width > kMaxSide_px || height > kMaxSide_px) {
        return fmt::format("image size {}x{} px must be between 2 and {} on each side",
                           width,
                           height,
                           kMaxSide_px);
    }
    if (auto found = std::visit([](const auto& m) { return m.problem(); }, model)) return found;
    const Eigen::Vector2d focal_px =
        std::visit([](const auto& m) { return Eigen::Vector2d(m.fx_px, m.fy_px); }, model);
    if (auto found = focal_problem(focal_px.maxCoeff())) return found;
    const Eigen::Vector2d centre =
        std::visit([](const auto& m) { return Eigen::Vector2d(m.cx_px, m.cy_px); }, model);
    if (centre.x() < 0.0 || centre.y() < 0.0 || centre.x() > width - 1 || centre.y() > height - 1) {
        return fmt::format(
            "principal point ({:.1f}, {:.1f}) px lies outside the {}x{} image; is this the "
            "calibration of another resolution?",
            centre.x(),
            centre.y(),
            width,
            height);
    }
    return std::nullopt;
}

}  // namespace surefoot::camera
