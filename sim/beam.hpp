// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

namespace surefoot::sim {

struct Sphere {
    Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
    double radius_m = 0.0;
};

/// All rays of a block of pixels: a narrow cone (half angle below 90 deg) in the world frame whose
/// tip may be anywhere in a small ball, because rows are exposed one after the other. The tests
/// below are proofs: they may fail to see that a thing is missed, never the other way round.
class Beam {
  public:
    /// Unit axis; `half_angle_rad` rounds its cosine up itself.
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
    /// Every ray meets the convex polygon, or none does: its corners counter-clockwise as the tip
    /// sees them, which lies `above_m` over its plane.
    [[nodiscard]] bool inside(std::span<const Eigen::Vector3d> polygon_m, double above_m) const;
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
