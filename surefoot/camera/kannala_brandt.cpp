// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/kannala_brandt.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "surefoot/camera/monotonic.hpp"

namespace surefoot::camera {
namespace {

/// Bisection alone needs 54 steps to reduce an interval of pi to the last bit. Newton needs about
/// five.
constexpr int kMaxSteps = 80;
/// Residual of the inverse in normalised coordinates (rad): 1e-12 times f = 1000 px is 1e-9 px.
constexpr double kConverged = 1e-12;

/// Returns d(theta): the distance from the principal point divided by the focal length.
double radius(const KannalaBrandt& m, double theta) {
    const double s = theta * theta;
    return theta * (1.0 + s * (m.k1 + s * (m.k2 + s * (m.k3 + s * m.k4))));
}

/// Returns the derivative d'(theta).
double slope(const KannalaBrandt& m, double theta) {
    const double s = theta * theta;
    return 1.0 + s * (3.0 * m.k1 + s * (5.0 * m.k2 + s * (7.0 * m.k3 + s * 9.0 * m.k4)));
}

/// True if d grows everywhere between the axis and theta.
bool inside_domain(const KannalaBrandt& m, double theta) {
    const std::array<double, 5> c{1.0, 3.0 * m.k1, 5.0 * m.k2, 7.0 * m.k3, 9.0 * m.k4};
    return positive_on(c, theta * theta);
}

/// Returns the angle whose image has this radius. Uses Newton's method within a bracket that
/// bisection shrinks.
std::optional<double> angle_of(const KannalaBrandt& m, double target) {
    double low = 0.0;
    double high = std::numbers::pi;
    double theta = target < high ? target : 0.5 * high;
    for (int step = 0; step < kMaxSteps; ++step) {
        const bool inside = inside_domain(m, theta);
        const double error = radius(m, theta) - target;
        if (inside && std::abs(error) <= kConverged * (1.0 + target)) {
            // One more Newton step uses the remaining quadratic convergence.
            return theta - error / slope(m, theta);
        }
        (inside && error < 0.0 ? low : high) = theta;
        const double newton = inside ? theta - error / slope(m, theta) : high;
        theta = newton > low && newton < high ? newton : 0.5 * (low + high);
    }
    return std::nullopt;
}

}  // namespace

std::optional<Eigen::Vector2d> KannalaBrandt::project(
    const Eigen::Vector3d& p_camera, Eigen::Matrix<double, 2, 3>* d_pixel_d_point) const {
    const double z = p_camera.z();
    const double r = std::hypot(p_camera.x(), p_camera.y());
    const double distance_sq = r * r + z * z;
    // A point straight behind has a circle as its image; a point at the origin has no image.
    if (!std::isfinite(distance_sq) || distance_sq == 0.0 || (r == 0.0 && z <= 0.0)) {
        return std::nullopt;
    }
    const double theta = std::atan2(r, z);
    if (!inside_domain(*this, theta)) return std::nullopt;
    const double d = radius(*this, theta);
    // On the axis all directions are equal: use (1, 0). There d/r tends to 1/z.
    const double cosine = r > 0.0 ? p_camera.x() / r : 1.0;
    const double sine = r > 0.0 ? p_camera.y() / r : 0.0;
    if (d_pixel_d_point != nullptr) {
        const double d_theta = slope(*this, theta);
        const double along = d_theta * z / distance_sq;   // radial stretch
        const double across = r > 0.0 ? d / r : 1.0 / z;  // tangential stretch
        const double depth = -d_theta * r / distance_sq;  // derivative of the image radius by z
        *d_pixel_d_point << fx_px * (cosine * cosine * along + sine * sine * across),
            fx_px * cosine * sine * (along - across), fx_px * cosine * depth,
            fy_px * cosine * sine * (along - across),
            fy_px * (sine * sine * along + cosine * cosine * across), fy_px * sine * depth;
    }
    return Eigen::Vector2d(fx_px * d * cosine + cx_px, fy_px * d * sine + cy_px);
}

std::optional<Eigen::Vector3d> KannalaBrandt::unproject(
    const Eigen::Vector2d& pixel, Eigen::Matrix<double, 3, 2>* d_ray_d_pixel) const {
    const double mx = (pixel.x() - cx_px) / fx_px;
    const double my = (pixel.y() - cy_px) / fy_px;
    const double d = std::hypot(mx, my);
    if (!std::isfinite(d)) return std::nullopt;
    const std::optional<double> theta = angle_of(*this, d);
    if (!theta) return std::nullopt;
    const double cosine = d > 0.0 ? mx / d : 1.0;
    const double sine = d > 0.0 ? my / d : 0.0;
    const double sin_theta = std::sin(*theta);
    const double cos_theta = std::cos(*theta);
    if (d_ray_d_pixel != nullptr) {
        const double d_theta = 1.0 / slope(*this, *theta);  // d theta / d radius
        const double along = cos_theta * d_theta;
        const double across = d > 0.0 ? sin_theta / d : 1.0;
        *d_ray_d_pixel << (cosine * cosine * along + sine * sine * across) / fx_px,
            cosine * sine * (along - across) / fy_px, cosine * sine * (along - across) / fx_px,
            (sine * sine * along + cosine * cosine * across) / fy_px,
            -sin_theta * d_theta * cosine / fx_px, -sin_theta * d_theta * sine / fy_px;
    }
    return Eigen::Vector3d(sin_theta * cosine, sin_theta * sine, cos_theta);
}

std::optional<std::string> KannalaBrandt::problem() const {
    const std::array<const char*, 8> names{
        "fx_px", "fy_px", "cx_px", "cy_px", "k1", "k2", "k3", "k4"};
    const std::array<double, 8> values{fx_px, fy_px, cx_px, cy_px, k1, k2, k3, k4};
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(values[i])) {
            return fmt::format("fisheye {} = {} is not a finite number", names[i], values[i]);
        }
    }
    for (std::size_t i = 0; i < 2; ++i) {
        if (values[i] <= 0.0) {
            return fmt::format("fisheye {} = {} must be > 0 px", names[i], values[i]);
        }
    }
    return std::nullopt;
}

}  // namespace surefoot::camera
