// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <optional>

/// Common code of the pinhole models with distortion; private to them. A model passes the function
///   std::optional<Distorted> distort(const Eigen::Vector2d& p)
/// on the plane z = 1. `distort` returns nullopt where the image does not grow outward.
namespace surefoot::camera::pinhole_solver {

inline constexpr int kMaxNewtonSteps = 200;  ///< 5 suffice in the image; more are needed far out
/// Largest residual of a converged inverse on the plane z = 1; 1e-10 px at f = 1000 px.
inline constexpr double kConverged = 1e-13;
/// Largest valid residual if rounding stops the steps earlier; 1e-7 px at f = 1000 px.
inline constexpr double kStalled = 1e-10;

struct Distorted {
    Eigen::Vector2d m;
    Eigen::Matrix2d J;  ///< d m / d (x, y)
};

struct Intrinsics {
    double fx_px, fy_px, cx_px, cy_px;
};

/// Radial factor and tangential terms of Brown 1966 at p. `d_radial` is d radial / d r^2.
[[nodiscard]] inline Distorted brown(
    const Eigen::Vector2d& p, double radial, double d_radial, double p1, double p2) {
    const double x = p.x();
    const double y = p.y();
    const double r2 = x * x + y * y;
    const double cross = 2.0 * x * y * d_radial + 2.0 * p1 * x + 2.0 * p2 * y;
    Distorted d;
    d.m << x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
        y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
    d.J << radial + 2.0 * x * x * d_radial + 2.0 * p1 * y + 6.0 * p2 * x, cross,  //
        cross, radial + 2.0 * y * y * d_radial + 6.0 * p1 * y + 2.0 * p2 * x;
    return d;
}

/// True if the image grows outward at a point in every direction: J (symmetric) is positive
/// definite. The determinant alone also accepts an image rotated by 180 deg, which tangential terms
/// cause far off the axis.
[[nodiscard]] inline bool grows(const Eigen::Matrix2d& J) {
    return J.determinant() > 0.0 && J.trace() > 0.0;
}

/// Newton's method from `target`, or else from the centre. Halves steps that do not improve.
template <typename Distort>
std::optional<Eigen::Vector2d> undistort(const Distort& distort, const Eigen::Vector2d& target) {
    Eigen::Vector2d p = target;
    std::optional<Distorted> at_p = distort(p);
    if (!at_p) {
        p.setZero();
        at_p = distort(p);
    }
    if (!at_p) return std::nullopt;
    double error = (target - at_p->m).norm();
    for (int step = 0; step < kMaxNewtonSteps && error > kConverged; ++step) {
        const Eigen::Vector2d delta = at_p->J.inverse() * (target - at_p->m);
        bool improved = false;
        for (double scale = 1.0; scale > 1e-6 && !improved; scale *= 0.5) {
            const Eigen::Vector2d trial = p + scale * delta;
            const std::optional<Distorted> at_trial = distort(trial);
            if (!at_trial || !((target - at_trial->m).norm() < error)) continue;
            p = trial;
            at_p = at_trial;
            error = (target - at_p->m).norm();
            improved = true;
        }
        if (!improved) break;
    }
    // The comparison with ! also rejects NaN. Far off the axis the rounding grows with |p|.
    if (!(error <= kStalled * (1.0 + target.norm()))) return std::nullopt;
    return p;
}

/// Returns the pixel of a point, or nullopt at or behind the camera plane or if `distort` fails.
template <typename Distort>
std::optional<Eigen::Vector2d> project(const Intrinsics& k,
                                       const Distort& distort,
                                       const Eigen::Vector3d& p_camera,
                                       Eigen::Matrix<double, 2, 3>* d_pixel_d_point) {
    if (!p_camera.allFinite() || p_camera.z() <= 0.0) return std::nullopt;
    const double inverse_z = 1.0 / p_camera.z();
    const Eigen::Vector2d p(p_camera.x() * inverse_z, p_camera.y() * inverse_z);
    const std::optional<Distorted> d = distort(p);
    if (!d) return std::nullopt;
    if (d_pixel_d_point != nullptr) {
        Eigen::Matrix<double, 2, 3> d_p_d_point;
        d_p_d_point << inverse_z, 0.0, -p.x() * inverse_z,  //
            0.0, inverse_z, -p.y() * inverse_z;
        *d_pixel_d_point = Eigen::Vector2d(k.fx_px, k.fy_px).asDiagonal() * d->J * d_p_d_point;
    }
    return Eigen::Vector2d(k.fx_px * d->m.x() + k.cx_px, k.fy_px * d->m.y() + k.cy_px);
}

/// Returns the unit ray of a pixel. `has_distortion` = false skips the iterations.
template <typename Distort>
std::optional<Eigen::Vector3d> unproject(const Intrinsics& k,
                                         const Distort& distort,
                                         bool has_distortion,
                                         const Eigen::Vector2d& pixel,
                                         Eigen::Matrix<double, 3, 2>* d_ray_d_pixel) {
    const Eigen::Vector2d m((pixel.x() - k.cx_px) / k.fx_px, (pixel.y() - k.cy_px) / k.fy_px);
    if (!m.allFinite()) return std::nullopt;
    const std::optional<Eigen::Vector2d> p = has_distortion ? undistort(distort, m) : m;
    if (!p) return std::nullopt;
    const double length = std::sqrt(p->squaredNorm() + 1.0);
    const Eigen::Vector3d ray = Eigen::Vector3d(p->x(), p->y(), 1.0) / length;
    if (d_ray_d_pixel != nullptr) {
        const std::optional<Distorted> d = distort(*p);
        if (!d) return std::nullopt;
        // d ray / d (x, y, 1) = (I - ray ray^T) / length; only x and y move.
        const Eigen::Matrix3d d_ray =
            (Eigen::Matrix3d::Identity() - ray * ray.transpose()) / length;
        *d_ray_d_pixel = d_ray.leftCols<2>() * d->J.inverse() *
                         Eigen::Vector2d(1.0 / k.fx_px, 1.0 / k.fy_px).asDiagonal();
    }
    return ray;
}

}  // namespace surefoot::camera::pinhole_solver
