// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/pinhole_radtan.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "surefoot/camera/monotonic.hpp"
#include "surefoot/camera/pinhole_solver.hpp"

namespace surefoot::camera {
namespace {

using pinhole_solver::Distorted;

/// True if the image grows outward from the axis to (x, y). The radial part is tested along the
/// whole line from the axis, by its derivative d(r radial)/dr. The tangential part is tested only
/// at the point, by the Jacobian.
bool inside_domain(const PinholeRadTan& model, double r2, const Eigen::Matrix2d& J) {
    const std::array<double, 4> slope{1.0, 3.0 * model.k1, 5.0 * model.k2, 7.0 * model.k3};
    return positive_on(slope, r2) && pinhole_solver::grows(J);
}

std::optional<Distorted> distort(const PinholeRadTan& model, const Eigen::Vector2d& p) {
    const double r2 = p.x() * p.x() + p.y() * p.y();
    const double radial = 1.0 + r2 * (model.k1 + r2 * (model.k2 + r2 * model.k3));
    const double d_radial = model.k1 + r2 * (2.0 * model.k2 + r2 * 3.0 * model.k3);  // d/d r2
    const Distorted d = pinhole_solver::brown(p, radial, d_radial, model.p1, model.p2);
    if (!d.m.allFinite() || !inside_domain(model, r2, d.J)) return std::nullopt;
    return d;
}

}  // namespace

std::optional<Eigen::Vector2d> PinholeRadTan::project(
    const Eigen::Vector3d& p_camera, Eigen::Matrix<double, 2, 3>* d_pixel_d_point) const {
    return pinhole_solver::project(
        {fx_px, fy_px, cx_px, cy_px},
        [this](const Eigen::Vector2d& p) { return distort(*this, p); },
        p_camera,
        d_pixel_d_point);
}

std::optional<Eigen::Vector3d> PinholeRadTan::unproject(
    const Eigen::Vector2d& pixel, Eigen::Matrix<double, 3, 2>* d_ray_d_pixel) const {
    return pinhole_solver::unproject(
        {fx_px, fy_px, cx_px, cy_px},
        [this](const Eigen::Vector2d& p) { return distort(*this, p); },
        has_distortion(),
        pixel,
        d_ray_d_pixel);
}

std::optional<std::string> PinholeRadTan::problem() const {
    const std::array<const char*, 9> names{
        "fx_px", "fy_px", "cx_px", "cy_px", "k1", "k2", "p1", "p2", "k3"};
    const std::array<double, 9> values{fx_px, fy_px, cx_px, cy_px, k1, k2, p1, p2, k3};
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(values[i])) {
            return fmt::format("pinhole {} = {} is not a finite number", names[i], values[i]);
        }
    }
    for (std::size_t i = 0; i < 2; ++i) {
        if (values[i] <= 0.0) {
            return fmt::format("pinhole {} = {} must be > 0 px", names[i], values[i]);
        }
    }
    return std::nullopt;
}

}  // namespace surefoot::camera
