// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <span>

#include "surefoot/geometry/plane_fit.hpp"

namespace surefoot::ground {

/// The plane near `start` through points seen from the origin, each with one sigma of its inverse
/// range [1/m].
///
/// A plane n . p + h = 0 is seen along the unit ray r at the inverse range w = -(n . r) / h: linear
/// in m = -n / h, as v-disparity is (Labayrade et al. 2002). Stereo errs in w, alike at all
/// distances, so that this least squares problem has no bias by distance and weights far points as
/// little as they deserve; three unknowns, solved again with weights after Tukey (biweight) until
/// they settle. Points farther than `band_m` from the plane take no part, nor do those whose noise
/// across it is too large to tell.
///
/// Nothing if too few points are near or they do not fix a plane in front of the camera.
[[nodiscard]] std::optional<geometry::Plane> refine_plane(
    std::span<const Eigen::Vector3d> points,
    std::span<const double> inverse_range_sigma,
    const geometry::Plane& start,
    double band_m);

/// The plane n . p + h = 0 in front of the camera with -n / h = m; nothing where m is none.
[[nodiscard]] std::optional<geometry::Plane> plane_of(const Eigen::Vector3d& m);

/// A band that cuts the noise of a point holds the plane in place: points with a sigma of more than
/// this share of it take no part.
inline constexpr double kNoisiest = 0.67;

/// A point seen from the origin, beside the place where its ray meets a plane.
struct Sighting {
    Eigen::Vector3d ray = Eigen::Vector3d::Zero();  ///< unit
    double inverse_range = 0.0;                     ///< [1/m]
    double expected_inverse_range = 0.0;            ///< of the plane; 0 = the ray does not meet it
    /// Distance from the plane and its one sigma, to first order in the inverse range: symmetric in
    /// the noise, so that what is left out by them pulls to neither side.
    double off_m = 0.0;
    double sigma_m = 0.0;

    /// Its noise is small enough to say whether it lies within a band, and it does.
    [[nodiscard]] bool is_within(double band_m) const {
        return expected_inverse_range > 0.0 && std::abs(off_m) <= band_m &&
               sigma_m <= kNoisiest * band_m;
    }
};

/// Where a point lies, seen from the origin; no beam leads to the origin or to what is not finite.
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
