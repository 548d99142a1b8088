// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "surefoot/geometry/plane_fit.hpp"

namespace surefoot::ground {

/// Covariance of m = -n / h (see `refine_plane`) [1/m^2], of a plane n . p + h = 0 that was settled
/// on points seen from the origin.
///
/// Neighbouring pixels err together: matching errors reach over some 40 px, and a bump of the
/// ground lifts all pixels on it. All points of a tile of 0.2 rad, or of 0.2 m seen from near, are
/// therefore one measurement. How far tiles lie off the plane is measured; where there are few
/// tiles, 0.6 of the scatter of single pixels counts as prior.
///
/// Points as for `refine_plane`; zero where none is near the plane.
[[nodiscard]] Eigen::Matrix3d covariance_of_m(std::span<const Eigen::Vector3d> points,
                                              std::span<const double> inverse_range_sigma,
                                              const geometry::Plane& plane,
                                              double band_m);

/// How sure a plane is: of its unit normal, and of the height of a point above it.
struct PlaneUncertainty {
    Eigen::Matrix3d normal_covariance = Eigen::Matrix3d::Zero();  ///< [rad^2], rank 2
    double height_var_m2 = 0.0;

    /// One sigma of the tilt about any axis along the plane.
    [[nodiscard]] double tilt_sigma_rad() const;
};

/// From the covariance of m, to first order. `base`: the point whose height is asked for, as seen
/// from the origin.
[[nodiscard]] PlaneUncertainty plane_uncertainty(const geometry::Plane& plane,
                                                 const Eigen::Matrix3d& covariance_of_m,
                                                 const Eigen::Vector3d& base);

}  // namespace surefoot::ground
