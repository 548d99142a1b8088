// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

namespace surefoot::sim {

struct Sphere {
    Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
    double radius_m = 0.0;
};

/// All rays of a block of pixels: a cone in the world frame. Its tip may be anywhere in a small
/// ball, because the rows are exposed one after another. The tests below are conservative: true is
/// proved for every ray, false may mean "not proved". From 90 deg of half angle on, all give false.
class Beam {
  public:
    Beam(const Eigen::Vector3d& tip_m,
         const Eigen::Vector3d& axis,
         double half_angle_rad,
         double tip_radius_m);

    [[nodiscard]] const Eigen::Vector3d& tip_m() const noexcept { return tip_m_; }
    [[nodiscard]] double tip_radius_m() const noexcept { return tip_radius_m_; }

    /// True if provably no ray meets the sphere.
    [[nodiscard]] bool misses(const Sphere& sphere) const;
    /// True if provably no ray meets the convex hull of the corners.
    [[nodiscard]] bool misses(std::span<const Eigen::Vector3d> corners_m) const;
    /// True if provably every ray meets the convex polygon. Corners: counter-clockwise as seen from
    /// the tip, which is `above_m` above the plane of the polygon.
    [[nodiscard]] bool inside(std::span<const Eigen::Vector3d> polygon_m, double above_m) const;
    /// True if provably no ray meets the polygon.
    [[nodiscard]] bool outside(std::span<const Eigen::Vector3d> polygon_m, double above_m) const;

  private:
    /// Sine of the half angle of a cone from the middle of the ball. The cone contains every point
    /// where a ray meets the plane. Above 1 if no such cone exists.
    [[nodiscard]] double sine_of_hits(double above_m) const;

    Eigen::Vector3d tip_m_;
    Eigen::Vector3d axis_;
    double half_angle_rad_ = 0.0;
    double sine_ = 0.0;
    double cosine_ = 1.0;
    double tip_radius_m_ = 0.0;
};

}  // namespace surefoot::sim
