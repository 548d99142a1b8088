// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "surefoot/geometry/kd_tree.hpp"

namespace surefoot::geometry {

/// Unit normal of the surface around a place: the direction in which the points of the ball are
/// thinnest. It points up (z > 0), a wall's along the larger of x and y. Nothing for fewer than
/// three points, or where they lie on one line or in one place.
[[nodiscard]] std::optional<Eigen::Vector3f> surface_normal(const KdTree& cloud,
                                                            const Eigen::Vector3f& middle_m,
                                                            float radius_m);

/// A surface through a few points.
struct LocalSurface {
    Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  ///< as `surface_normal`
    float thickness_m = 0.0F;  ///< root mean square of the points across it: noise, or an edge
};

/// The same of the neighbours that a search found around `middle_m`, however many others are just
/// as near: the cost does not depend on the density of the cloud.
[[nodiscard]] std::optional<LocalSurface> surface_of_neighbours(const KdTree& cloud,
                                                                const Eigen::Vector3f& middle_m,
                                                                std::span<const Neighbour> near);

}  // namespace surefoot::geometry
