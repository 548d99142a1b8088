// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/geometry/plane_fit.hpp"

namespace surefoot::geometry {

/// Only planes whose normal (either sign) lies within `max_angle_rad` of `direction` are
/// considered.
struct NormalCone {
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< need not be a unit vector
    double max_angle_rad = 0.3;
};

struct RansacPlaneOptions {
    double tolerance_m = 0.05;  ///< a point within this distance of the plane is an inlier
    /// Distance for each point instead, and near ones count more; empty = `tolerance_m` for all.
    std::span<const double> tolerance_of_m;
    double confidence = 0.9999;  ///< of having drawn three inliers at least once; ends the search
    int max_iterations = 1000;
    /// Share of the points; the search also ends when a plane with so many would have been found.
    double least_inlier_ratio = 0.0;
    int max_refinements = 8;  ///< refits on the inliers until these stay the same
    std::optional<NormalCone> cone;
};

struct RansacPlane {
    PlaneFit fit;  ///< of the inliers; normal on the side of the cone's direction, else z >= 0
    std::vector<int> inliers;   ///< indices into the points, ascending
    double inlier_ratio = 0.0;  ///< of the finite points
    int iterations = 0;         ///< triples drawn
};

/// The plane with the most inliers (Fischler and Bolles 1981), refitted on them by least squares.
/// Nothing if no admissible triple was drawn or the refined plane leaves the cone. The same points,
/// options and generator state give the same plane; points that are not finite are never inliers.
[[nodiscard]] std::optional<RansacPlane> ransac_plane(std::span<const Eigen::Vector3d> points,
                                                      const RansacPlaneOptions& options,
                                                      Rng& rng);

}  // namespace surefoot::geometry
