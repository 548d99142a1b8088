// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "surefoot/geometry/plane_fit.hpp"

namespace surefoot::ground {

/// The part of a plane that is nearer to the sensor.
struct NearSide {
    geometry::Plane plane;  ///< fitted to the points of this part that lie within the band
    Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< unit vector along the plane
    double from_m = 0.0;                              ///< start of the part along `axis`
    double to_m = 0.0;

    [[nodiscard]] bool contains(const Eigen::Vector3d& p) const {
        const double at_m = axis.dot(p);
        return at_m >= from_m && at_m <= to_m;
    }
};

/// Detects a plane that was fitted across a step. Two equally long levels 75 mm apart scatter
/// by 19 mm (rms) about a slope through both, hardly more than the noise of one pixel. More points
/// agree with this slope than with either level, but all points together reveal the step. A line
/// across or along the view splits the points within `band_m` of the plane where two planes fit
/// best. If they fit clearly better than one, the function returns the side of the sensor (origin).
///
/// Points and sigmas as for `refine_plane`. Returns nothing if one plane is enough.
[[nodiscard]] std::optional<NearSide> near_side(std::span<const Eigen::Vector3d> points,
                                                std::span<const double> inverse_range_sigma,
                                                const geometry::Plane& plane,
                                                double band_m);

}  // namespace surefoot::ground
