// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "surefoot/geometry/plane_fit.hpp"

namespace surefoot::ground {

/// The part of a plane that is nearer to the sensor.
struct NearSide {
    geometry::Plane plane;  ///< fitted to the points of this part that lie near the whole plane
    Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< unit vector along the plane
    double from_m = 0.0;                              ///< begin of the part along `axis`
    double to_m = 0.0;

    [[nodiscard]] bool contains(const Eigen::Vector3d& p) const {
        const double at_m = axis.dot(p);
        return at_m >= from_m && at_m <= to_m;
    }
};

/// Detects a plane that was fitted across a step. Two levels 75 mm apart lie within 19 mm of a
/// slope between them, hardly more than the noise of one pixel. More points agree with this slope
/// than with either level, but all points together reveal the step. The function splits the points
/// within `band_m` by a line across or along the view where two planes fit best. If two planes fit
/// clearly better than one, it returns the plane on the side of the sensor (the origin).
///
/// Points and sigmas as for `refine_plane`. Returns nothing if one plane is enough.
[[nodiscard]] std::optional<NearSide> near_side(std::span<const Eigen::Vector3d> points,
                                                std::span<const double> inverse_range_sigma,
                                                const geometry::Plane& plane,
                                                double band_m);

}  // namespace surefoot::ground
