// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "surefoot/geometry/kd_tree.hpp"

namespace surefoot::geometry {

/// Returns the unit normal of the surface around `middle_m`: the direction in which the points of
/// the ball are thinnest. It points up (z > 0), or on a wall along +x or +y (the larger). Returns
/// nullopt for fewer than three points, or for points on one line or at one position.
[[nodiscard]] std::optional<Eigen::Vector3f> surface_normal(const KdTree& cloud,
                                                            const Eigen::Vector3f& middle_m,
                                                            float radius_m);

/// Normal and scatter of a surface near a point of a cloud.
struct LocalSurface {
    Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  ///< unit normal as from `surface_normal`
    float thickness_m = 0.0F;  ///< rms of the points across the surface: noise, or an edge
};

/// Returns the surface through the neighbours that a search found around `middle_m`. Other points
/// at equal distance are ignored, so that the cost does not depend on the density of the cloud.
[[nodiscard]] std::optional<LocalSurface> surface_of_neighbours(const KdTree& cloud,
                                                                const Eigen::Vector3f& middle_m,
                                                                std::span<const Neighbour> near);

}  // namespace surefoot::geometry
