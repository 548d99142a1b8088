// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

namespace surefoot::geometry {

/// Plane normal . p + offset_m = 0 with a unit normal, in the frame of its points.
struct Plane {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    double offset_m = 0.0;

    /// Returns the distance from the plane: positive on the side to which the normal points.
    [[nodiscard]] double signed_distance_m(const Eigen::Vector3d& p) const {
        return normal.dot(p) + offset_m;
    }
    /// Returns this plane with its normal pointing to the side of `direction`.
    [[nodiscard]] Plane facing(const Eigen::Vector3d& direction) const {
        return normal.dot(direction) < 0.0 ? Plane{-normal, -offset_m} : *this;
    }
};

/// Least-squares plane of some points, with their scatter (one sigma, divided by n) along the three
/// principal directions.
struct PlaneFit {
    Plane plane;  ///< normal.z >= 0
    Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();
    double rms_m = 0.0;           ///< scatter across the plane
    double narrow_sigma_m = 0.0;  ///< smaller scatter in the plane
    double wide_sigma_m = 0.0;    ///< larger scatter in the plane
    int count = 0;                ///< number of finite points used
};

/// Total least squares (smallest eigenvector of the covariance about the centroid). Ignores points
/// that are not finite. Returns nullopt for fewer than three points or for points on one line
/// (scatter across the line below a millionth of the scatter along it).
[[nodiscard]] std::optional<PlaneFit> fit_plane(std::span<const Eigen::Vector3d> points);

/// Fits a plane to the points at `indices`, with the rules of the function above.
[[nodiscard]] std::optional<PlaneFit> fit_plane(std::span<const Eigen::Vector3d> points,
                                                std::span<const int> indices);

}  // namespace surefoot::geometry
