// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace surefoot::ground {

/// Indices of the first point in every cube of side `voxel_m`, ascending; points farther than
/// `max_range_m` from `sensor_origin` or not finite are left out. If more than `max_points` remain,
/// every k-th of them is taken. What remains is spread by surface, not by pixel.
[[nodiscard]] std::vector<std::size_t> thin(std::span<const Eigen::Vector3d> points,
                                            const Eigen::Vector3d& sensor_origin,
                                            double max_range_m,
                                            double voxel_m,
                                            std::size_t max_points);

/// Area of the squares (of side `square_m`) that hold a point when seen along the unit `normal`.
[[nodiscard]] double covered_area_m2(std::span<const Eigen::Vector3d> points,
                                     const Eigen::Vector3d& normal,
                                     double square_m);

}  // namespace surefoot::ground
