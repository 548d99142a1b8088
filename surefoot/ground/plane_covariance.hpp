// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "surefoot/geometry/plane_fit.hpp"

namespace surefoot::ground {

/// Covariance [1/m^2] of m = -n / h (see `refine_plane`) for a plane n . p + h = 0 that was fitted
/// to points seen from the origin.
///
/// Errors of neighbouring pixels are correlated: matching errors extend over about 40 px, and a
/// bump of the ground lifts all its pixels. All points of a tile of 0.2 rad, or of 0.2 m at short
/// range, therefore count as one measurement. The scatter of the tiles about the plane is measured;
/// with few tiles, 0.6 of the scatter of single pixels serves as prior.
///
/// Points as for `refine_plane`. Returns zero if no point is near the plane.
[[nodiscard]] Eigen::Matrix3d covariance_of_m(std::span<const Eigen::Vector3d> points,
                                              std::span<const double> inverse_range_sigma,
                                              const geometry::Plane& plane,
                                              double band_m);

/// Uncertainty of a plane: of its unit normal, and of the height of a point above it.
struct PlaneUncertainty {
    Eigen::Matrix3d normal_covariance = Eigen::Matrix3d::Zero();  ///< of the normal [rad^2]; rank 2
    double height_var_m2 = 0.0;

    /// One sigma of the tilt about any axis along the plane.
    [[nodiscard]] double tilt_sigma_rad() const;
};

/// Returns the uncertainty from the covariance of m, to first order. `base`: the point whose height
/// is meant, relative to the origin.
[[nodiscard]] PlaneUncertainty plane_uncertainty(const geometry::Plane& plane,
                                                 const Eigen::Matrix3d& covariance_of_m,
                                                 const Eigen::Vector3d& base);

}  // namespace surefoot::ground
