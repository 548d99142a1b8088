// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

namespace surefoot::sim {

struct Sphere {
    Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
    double radius_m = 0.0;
};

/// All rays of a block of pixels: a cone in the world frame whose tip may be anywhere in a small
/// ball, because rows are exposed one after the other. The tests below are proofs: what they say
/// holds for every ray; they may fail to see it (always from 90 deg of half angle on).
class Beam {
  public:
    Beam(const Eigen::Vector3d& tip_m,
         const Eigen::Vector3d& axis,
         double half_angle_rad,
         double tip_radius_m);

    [[nodiscard]] const Eigen::Vector3d& tip_m() const noexcept { return tip_m_; }
    [[nodiscard]] double tip_radius_m() const noexcept { return tip_radius_m_; }

    /// No ray meets the sphere.
    [[nodiscard]] bool misses(const Sphere& sphere) const;
    /// No ray meets the convex hull of the corners.
    [[nodiscard]] bool misses(std::span<const Eigen::Vector3d> corners_m) const;
    /// Every ray meets the convex polygon: its corners counter-clockwise as seen from the tip,
    /// which lies `above_m` over its plane.
    [[nodiscard]] bool inside(std::span<const Eigen::Vector3d> polygon_m, double above_m) const;
    /// No ray meets it.
    [[nodiscard]] bool outside(std::span<const Eigen::Vector3d> polygon_m, double above_m) const;

  private:
    /// Sine of the half angle of the cone from the middle of the ball that holds every place where
    /// a ray meets a plane; above 1 where there is none.
    [[nodiscard]] double sine_of_hits(double above_m) const;

    Eigen::Vector3d tip_m_;
    Eigen::Vector3d axis_;
    double half_angle_rad_ = 0.0;
    double sine_ = 0.0;
    double cosine_ = 1.0;
    double tip_radius_m_ = 0.0;
};

}  // namespace surefoot::sim
