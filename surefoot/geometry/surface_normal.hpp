// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "surefoot/geometry/kd_tree.hpp"

namespace surefoot::geometry {

/// Unit normal of the surface around a place: the direction in which the points of the ball are
/// thinnest. It points up (z > 0), a wall's along the larger of x and y. Nothing for fewer than
/// three points, or where they lie on one line or in one place.
[[nodiscard]] std::optional<Eigen::Vector3f> surface_normal(const KdTree& cloud,
                                                            const Eigen::Vector3f& middle_m,
                                                            float radius_m);

}  // namespace surefoot::geometry
