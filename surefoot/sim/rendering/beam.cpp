// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/beam.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

/// Margin for rounding errors of angles and of products of coordinates up to 1 km.
constexpr double kMargin_rad = 1e-6;
constexpr double kMargin_m = 1e-9;

/// Sine of the angle between the axis and the plane through the tip and an edge of a polygon.
/// Positive on the inner side of the plane, negative on the outer side.
double sine_inside(const Vector3d& to_a_m, const Vector3d& to_b_m, const Vector3d& axis) {
    const Vector3d inward = to_b_m.cross(to_a_m);
    const double length = inward.norm();
    return length > 0.0 ? axis.dot(inward) / length : 0.0;
}

}  // namespace

Beam::Beam(const Vector3d& tip_m, const Vector3d& axis, double half_angle_rad, double tip_radius_m)
    : tip_m_(tip_m),
      axis_(axis),
      half_angle_rad_(half_angle_rad + kMargin_rad),
      sine_(std::sin(half_angle_rad_)),
      cosine_(std::cos(half_angle_rad_)),
      tip_radius_m_(tip_radius_m + kMargin_m) {}

/// Uses the distance from the centre to the nearest straight line of the cone surface, which is
/// extended behind the tip. Behind the tip the true distance is larger than this value, so the test
/// stays conservative.
bool Beam::misses(const Sphere& sphere) const {
    if (!(cosine_ > 0.0)) return false;
    const Vector3d to_center = sphere.center_m - tip_m_;
    const double along_m = axis_.dot(to_center);
    const double across_m = std::sqrt(std::max(to_center.squaredNorm() - along_m * along_m, 0.0));
    return across_m * cosine_ - along_m * sine_ > sphere.radius_m + tip_radius_m_;
}

/// Searches for a separating plane among the planes that touch the cone on eight sides.
bool Beam::misses(std::span<const Vector3d> corners_m) const {
    if (!(cosine_ > 0.0)) return false;
    const Vector3d side = axis_.unitOrthogonal();
    const Vector3d other = axis_.cross(side);
    const double half = std::numbers::sqrt2 / 2.0;
    const std::array<Vector3d, 8> outward{side,
                                          -side,
                                          other,
                                          -other,
                                          half * (side + other),
                                          half * (side - other),
                                          half * (other - side),
                                          -half * (side + other)};
    return std::any_of(outward.begin(), outward.end(), [&](const Vector3d& direction) {
        const Vector3d normal = cosine_ * direction - sine_ * axis_;
        const double reach_m = normal.dot(tip_m_) + tip_radius_m_;
        return std::all_of(corners_m.begin(), corners_m.end(), [&](const Vector3d& corner_m) {
            return normal.dot(corner_m) > reach_m;
        });
    });
}

double Beam::sine_of_hits(double above_m) const {
    // Seen from two viewpoints in the ball around the tip, the direction to a point at least
    // `above_m` away differs by at most the asin() below.
    if (!(above_m > 2.0 * tip_radius_m_)) return 2.0;
    const double angle_rad = half_angle_rad_ + std::asin(tip_radius_m_ / (above_m - tip_radius_m_));
    return angle_rad < 0.5 * std::numbers::pi ? std::sin(angle_rad) : 2.0;
}

bool Beam::inside(std::span<const Vector3d> polygon_m, double above_m) const {
    const double sine = sine_of_hits(above_m);
    Vector3d to_last_m = polygon_m.back() - tip_m_;
    for (const Vector3d& corner_m : polygon_m) {
        const Vector3d to_corner_m = corner_m - tip_m_;
        if (sine_inside(to_last_m, to_corner_m, axis_) < sine) return false;
        to_last_m = to_corner_m;
    }
    return true;
}

bool Beam::outside(std::span<const Vector3d> polygon_m, double above_m) const {
    const double sine = sine_of_hits(above_m);
    Vector3d to_last_m = polygon_m.back() - tip_m_;
    for (const Vector3d& corner_m : polygon_m) {
        const Vector3d to_corner_m = corner_m - tip_m_;
        if (sine_inside(to_last_m, to_corner_m, axis_) < -sine) return true;
        to_last_m = to_corner_m;
    }
    return false;
}

}  // namespace surefoot::sim
