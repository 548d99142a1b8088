// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace surefoot::ground {

/// Returns the index of the first point in every cube of side `voxel_m`, ascending. Ignores points
/// that are not finite or farther than `max_range_m` from `sensor_origin`. Above `max_points`, only
/// every k-th index is kept. The points are then spread by surface, not by pixel.
[[nodiscard]] std::vector<std::size_t> thin(std::span<const Eigen::Vector3d> points,
                                            const Eigen::Vector3d& sensor_origin,
                                            double max_range_m,
                                            double voxel_m,
                                            std::size_t max_points);

/// Returns the area of the squares of side `square_m` that hold a point, seen along `normal`.
[[nodiscard]] double covered_area_m2(std::span<const Eigen::Vector3d> points,
                                     const Eigen::Vector3d& normal,
                                     double square_m);

}  // namespace surefoot::ground
