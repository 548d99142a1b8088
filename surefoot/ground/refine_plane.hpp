// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <span>

#include "surefoot/geometry/plane_fit.hpp"

namespace surefoot::ground {

/// Fits the plane near `start` to points seen from the origin; each point has one sigma of its
/// inverse range [1/m].
///
/// Along the unit ray r, a plane n . p + h = 0 appears at the inverse range w = -(n . r) / h. This
/// is linear in m = -n / h, as in v-disparity (Labayrade et al. 2002). The noise of stereo in w
/// does not depend on the distance. So this least squares problem has no bias by distance and gives
/// far points their correct small weight. Tukey's biweight is used until the three unknowns
/// converge. Points farther than `band_m` from the plane, or too noisy to decide this, are left
/// out.
///
/// Returns nothing if too few points are near, or if they fix no plane in front of the camera.
[[nodiscard]] std::optional<geometry::Plane> refine_plane(
    std::span<const Eigen::Vector3d> points,
    std::span<const double> inverse_range_sigma,
    const geometry::Plane& start,
    double band_m);

/// Returns the plane n . p + h = 0 in front of the camera with -n / h = m, if m is valid.
[[nodiscard]] std::optional<geometry::Plane> plane_of(const Eigen::Vector3d& m);

/// A band that cuts off the noise of a point pulls the plane back to its start. Points whose sigma
/// exceeds this share of the band are therefore left out.
inline constexpr double kNoisiest = 0.67;

/// A point seen from the origin, compared with the point where its ray meets a plane.
struct Sighting {
    Eigen::Vector3d ray = Eigen::Vector3d::Zero();  ///< unit
    double inverse_range = 0.0;                     ///< [1/m]
    double expected_inverse_range = 0.0;  ///< inverse range of the plane; 0 = ray misses it
    /// Distance from the plane and its one sigma, to first order in the inverse range. The distance
    /// is symmetric in the noise, so a limit on it causes no bias.
    double off_m = 0.0;
    double sigma_m = 0.0;

    /// True if the point lies within the band and has small enough noise to decide this.
    [[nodiscard]] bool is_within(double band_m) const {
        return expected_inverse_range > 0.0 && std::abs(off_m) <= band_m &&
               sigma_m <= kNoisiest * band_m;
    }
};

/// Direction and inverse range of a point from the origin; 0 for the origin and if not finite.
struct Beam {
    Eigen::Vector3d ray = Eigen::Vector3d::Zero();  ///< unit
    double inverse_range = 0.0;                     ///< [1/m]
};
[[nodiscard]] inline Beam beam_to(const Eigen::Vector3d& p) {
    const double range_m = p.norm();
    if (!(range_m > 0.0) || !std::isfinite(range_m)) return {};
    return {p / range_m, 1.0 / range_m};
}

[[nodiscard]] inline Sighting sighting_of(const Beam& beam,
                                          double inverse_range_sigma,
                                          const geometry::Plane& plane) {
    Sighting sighting;
    sighting.ray = beam.ray;
    sighting.inverse_range = beam.inverse_range;
    const double fall = -plane.normal.dot(beam.ray);
    if (!(fall > 0.0) || !(plane.offset_m > 0.0)) return sighting;
    sighting.expected_inverse_range = fall / plane.offset_m;
    const double m_per_inverse = plane.offset_m / sighting.expected_inverse_range;
    sighting.off_m = m_per_inverse * (sighting.inverse_range - sighting.expected_inverse_range);
    sighting.sigma_m = m_per_inverse * inverse_range_sigma;
    return sighting;
}

}  // namespace surefoot::ground
