// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/pinhole_radtan.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "surefoot/camera/monotonic.hpp"

namespace surefoot::camera {
namespace {

constexpr int kMaxNewtonSteps = 200;  ///< five in an image, many from far outside
/// Residual of the inverse in normalised coordinates: 1e-13 times f = 1000 px is far below any use.
constexpr double kConverged = 1e-13;
/// What rounding may leave when the steps stall, still 1e-7 px at f = 1000.
constexpr double kStalled = 1e-10;

struct Distorted {
    Eigen::Vector2d m;
    Eigen::Matrix2d J;  ///< d m / d (x, y)
};

/// The image keeps growing outward from the axis to (x, y): radial part by its derivative
/// d(r radial)/dr on the whole way, tangential part by the Jacobian at the point.
bool inside_domain(const PinholeRadTan& model, double r2, const Eigen::Matrix2d& J) {
    const std::array<double, 4> slope{1.0, 3.0 * model.k1, 5.0 * model.k2, 7.0 * model.k3};
    return positive_on(slope, r2) && J.determinant() > 0.0;
}

std::optional<Distorted> distort(const PinholeRadTan& model, const Eigen::Vector2d& p) {
    const double x = p.x();
    const double y = p.y();
    const double r2 = x * x + y * y;
    const double radial = 1.0 + r2 * (model.k1 + r2 * (model.k2 + r2 * model.k3));
    const double d_radial = model.k1 + r2 * (2.0 * model.k2 + r2 * 3.0 * model.k3);  // d/d r2
    const double cross = 2.0 * x * y * d_radial + 2.0 * model.p1 * x + 2.0 * model.p2 * y;
    Distorted d;
    d.m << x * radial + 2.0 * model.p1 * x * y + model.p2 * (r2 + 2.0 * x * x),
        y * radial + model.p1 * (r2 + 2.0 * y * y) + 2.0 * model.p2 * x * y;
    d.J << radial + 2.0 * x * x * d_radial + 2.0 * model.p1 * y + 6.0 * model.p2 * x, cross,  //
        cross, radial + 2.0 * y * y * d_radial + 6.0 * model.p1 * y + 2.0 * model.p2 * x;
    if (!d.m.allFinite() || !inside_domain(model, r2, d.J)) return std::nullopt;
    return d;
}

/// Newton from the centre outward; steps that leave the domain or do not help are halved.
std::optional<Eigen::Vector2d> undistort(const PinholeRadTan& model,
                                         const Eigen::Vector2d& target) {
    Eigen::Vector2d p = target;
    std::optional<Distorted> at_p = distort(model, p);
    if (!at_p) {
        p.setZero();
        at_p = distort(model, p);
    }
    if (!at_p) return std::nullopt;
    double error = (target - at_p->m).norm();
    for (int step = 0; step < kMaxNewtonSteps && error > kConverged; ++step) {
        const Eigen::Vector2d delta = at_p->J.inverse() * (target - at_p->m);
        bool improved = false;
        for (double scale = 1.0; scale > 1e-6 && !improved; scale *= 0.5) {
            const Eigen::Vector2d trial = p + scale * delta;
            const std::optional<Distorted> at_trial = distort(model, trial);
            if (!at_trial || !((target - at_trial->m).norm() < error)) continue;
            p = trial;
            at_p = at_trial;
            error = (target - at_p->m).norm();
            improved = true;
        }
        if (!improved) break;
    }
    // Negated: NaN has not converged. Far off axis the rounding grows with the point itself.
    if (!(error <= kStalled * (1.0 + target.norm()))) return std::nullopt;
    return p;
}

}  // namespace

std::optional<Eigen::Vector2d> PinholeRadTan::project(
    const Eigen::Vector3d& p_camera, Eigen::Matrix<double, 2, 3>* d_pixel_d_point) const {
    if (!p_camera.allFinite() || p_camera.z() <= 0.0) return std::nullopt;
    const double inverse_z = 1.0 / p_camera.z();
    const Eigen::Vector2d p(p_camera.x() * inverse_z, p_camera.y() * inverse_z);
    const std::optional<Distorted> d = distort(*this, p);
    if (!d) return std::nullopt;
    if (d_pixel_d_point != nullptr) {
        Eigen::Matrix<double, 2, 3> d_p_d_point;
        d_p_d_point << inverse_z, 0.0, -p.x() * inverse_z,  //
            0.0, inverse_z, -p.y() * inverse_z;
        *d_pixel_d_point = Eigen::Vector2d(fx_px, fy_px).asDiagonal() * d->J * d_p_d_point;
    }
    return Eigen::Vector2d(fx_px * d->m.x() + cx_px, fy_px * d->m.y() + cy_px);
}

std::optional<Eigen::Vector3d> PinholeRadTan::unproject(
    const Eigen::Vector2d& pixel, Eigen::Matrix<double, 3, 2>* d_ray_d_pixel) const {
    const Eigen::Vector2d m((pixel.x() - cx_px) / fx_px, (pixel.y() - cy_px) / fy_px);
    if (!m.allFinite()) return std::nullopt;
    const std::optional<Eigen::Vector2d> p = has_distortion() ? undistort(*this, m) : m;
    if (!p) return std::nullopt;
    const double length = std::sqrt(p->squaredNorm() + 1.0);
    const Eigen::Vector3d ray = Eigen::Vector3d(p->x(), p->y(), 1.0) / length;
    if (d_ray_d_pixel != nullptr) {
        const std::optional<Distorted> d = distort(*this, *p);
        if (!d) return std::nullopt;
        // d ray / d (x, y, 1) = (I - ray ray^T) / length; only x and y move.
        const Eigen::Matrix3d d_ray =
            (Eigen::Matrix3d::Identity() - ray * ray.transpose()) / length;
        *d_ray_d_pixel = d_ray.leftCols<2>() * d->J.inverse() *
                         Eigen::Vector2d(1.0 / fx_px, 1.0 / fy_px).asDiagonal();
    }
    return ray;
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
