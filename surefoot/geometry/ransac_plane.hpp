// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/geometry/plane_fit.hpp"

namespace surefoot::geometry {

/// Restricts the search to planes whose normal (either sign) lies within `max_angle_rad` of
/// `direction`.
struct NormalCone {
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< need not be a unit vector
    double max_angle_rad = 0.3;
};

struct RansacPlaneOptions {
    double tolerance_m = 0.05;  ///< a point within this distance of the plane is an inlier
    /// Tolerance per point; nearer inliers count more. Empty = `tolerance_m` for all points.
    std::span<const double> tolerance_of_m;
    double confidence = 0.9999;  ///< wanted probability of having drawn a triple of inliers
    int max_iterations = 1000;
    /// The search ends when it has probably (`confidence`) drawn a plane with this share of points.
    double least_inlier_ratio = 0.0;
    int max_refinements = 8;  ///< largest number of refits on the inliers
    std::optional<NormalCone> cone;
};

struct RansacPlane {
    PlaneFit fit;  ///< fit to the inliers; normal on the side of the cone, or z >= 0 without cone
    std::vector<int> inliers;   ///< indices into the points, ascending
    double inlier_ratio = 0.0;  ///< share of the finite points
    int iterations = 0;         ///< number of triples drawn
};

/// Returns the plane with the most inliers (Fischler and Bolles 1981), refitted by least squares.
/// Returns nullopt without an admissible triple, or if the refined plane leaves the cone.
/// Deterministic for equal points, options and generator state. Only finite points can be inliers.
[[nodiscard]] std::optional<RansacPlane> ransac_plane(std::span<const Eigen::Vector3d> points,
                                                      const RansacPlaneOptions& options,
                                                      Rng& rng);

}  // namespace surefoot::geometry
