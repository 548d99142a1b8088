// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/pinhole_rational.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "surefoot/camera/monotonic.hpp"
#include "surefoot/camera/pinhole_solver.hpp"

namespace surefoot::camera {
namespace {

using pinhole_solver::Distorted;

/// N and D of radial = N / D, by powers of s = r^2.
using Cubic = std::array<double, 4>;

double value(const Cubic& c, double s) {
    return c[0] + s * (c[1] + s * (c[2] + s * c[3]));
}

double slope(const Cubic& c, double s) {
    return c[1] + s * (2.0 * c[2] + s * 3.0 * c[3]);
}

/// sum of a_i b_j factor(i, j) s^(i + j): the weighted coefficients of a product.
template <typename Factor>
std::array<double, 7> product(const Cubic& a, const Cubic& b, const Factor& factor) {
    std::array<double, 7> c{};
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) c[i + j] += a[i] * b[j] * factor(i, j);
    }
    return c;
}

/// True if the Jacobian J of the distortion is positive definite on the whole disc of radius r. The
/// disc is convex, so no two of its points then share a pixel. The radial part has the eigenvalues
///   d(r N/D)/dr = sum N_i D_j (1 + 2 i - 2 j) s^(i + j) / D^2   and   N/D = N D / D^2.
/// The eigenvalues of the tangential part lie within +-6 |(p1, p2)| r. So each radial eigenvalue
/// minus this bound must be positive. Multiplied by D^2, with D > 0, both differences are
/// polynomials in s.
bool inside_domain(const PinholeRational& model, const Cubic& N, const Cubic& D, double r2) {
    const double tangential = 6.0 * std::hypot(model.p1, model.p2) * std::sqrt(r2);
    const auto one = [](std::size_t, std::size_t) { return 1.0; };
    const std::array<double, 7> squared = product(D, D, one);
    std::array<double, 7> along = product(N, D, [](std::size_t i, std::size_t j) {
        return 1.0 + 2.0 * static_cast<double>(i) - 2.0 * static_cast<double>(j);
    });
    std::array<double, 7> across = product(N, D, one);
    for (std::size_t i = 0; i < squared.size(); ++i) {
        along[i] -= tangential * squared[i];
        across[i] -= tangential * squared[i];
    }
    return positive_on(D, r2) && positive_on(along, r2) && positive_on(across, r2);
}

std::optional<Distorted> distort(const PinholeRational& model, const Eigen::Vector2d& p) {
    const Cubic N{1.0, model.k1, model.k2, model.k3};
    const Cubic D{1.0, model.k4, model.k5, model.k6};
    const double r2 = p.x() * p.x() + p.y() * p.y();
    const double denominator = value(D, r2);
    const double radial = value(N, r2) / denominator;
    const double d_radial = (slope(N, r2) - radial * slope(D, r2)) / denominator;
    const Distorted d = pinhole_solver::brown(p, radial, d_radial, model.p1, model.p2);
    if (!d.m.allFinite() || !inside_domain(model, N, D, r2)) {
        return std::nullopt;
    }
    return d;
}

}  // namespace

std::optional<Eigen::Vector2d> PinholeRational::project(
    const Eigen::Vector3d& p_camera, Eigen::Matrix<double, 2, 3>* d_pixel_d_point) const {
    return pinhole_solver::project(
        {fx_px, fy_px, cx_px, cy_px},
        [this](const Eigen::Vector2d& p) { return distort(*this, p); },
        p_camera,
        d_pixel_d_point);
}

std::optional<Eigen::Vector3d> PinholeRational::unproject(
    const Eigen::Vector2d& pixel, Eigen::Matrix<double, 3, 2>* d_ray_d_pixel) const {
    return pinhole_solver::unproject(
        {fx_px, fy_px, cx_px, cy_px},
        [this](const Eigen::Vector2d& p) { return distort(*this, p); },
        has_distortion(),
        pixel,
        d_ray_d_pixel);
}

std::optional<std::string> PinholeRational::problem() const {
    const std::array<const char*, 12> names{
        "fx_px", "fy_px", "cx_px", "cy_px", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
    const std::array<double, 12> values{fx_px, fy_px, cx_px, cy_px, k1, k2, p1, p2, k3, k4, k5, k6};
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(values[i])) {
            return fmt::format(
                "rational pinhole {} = {} is not a finite number", names[i], values[i]);
        }
    }
    for (std::size_t i = 0; i < 2; ++i) {
        if (values[i] <= 0.0) {
            return fmt::format("rational pinhole {} = {} must be > 0 px", names[i], values[i]);
        }
    }
    return std::nullopt;
}

}  // namespace surefoot::camera
