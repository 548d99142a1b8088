// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "surefoot/geometry/plane_fit.hpp"

namespace surefoot::ground {

/// The part of a plane that is nearer to the sensor.
struct NearSide {
    geometry::Plane plane;  ///< of the points there that were near the whole plane
    Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< unit, along the plane
    double from_m = 0.0;                              ///< along the axis
    double to_m = 0.0;

    [[nodiscard]] bool contains(const Eigen::Vector3d& p) const {
        const double at_m = axis.dot(p);
        return at_m >= from_m && at_m <= to_m;
    }
};

/// A plane laid across a step: two levels 75 mm apart lie within 19 mm of a slope between them,
/// hardly more than the noise of one pixel, and more points agree with it than with either level.
/// All points together tell: this splits those within `band_m` of the plane by a line across the
/// view or along it, where two planes fit them best, and returns the one on the side of the sensor
/// (the origin), if two are clearly better than one.
///
/// Points and sigmas as for `refine_plane`. Nothing where the plane is one.
[[nodiscard]] std::optional<NearSide> near_side(std::span<const Eigen::Vector3d> points,
                                                std::span<const double> inverse_range_sigma,
                                                const geometry::Plane& plane,
                                                double band_m);

}  // namespace surefoot::ground
