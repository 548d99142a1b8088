// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/geometry/point_box.hpp"

namespace surefoot::eval {

/// Returns the voxel index along one axis. Voxel borders are multiples of the size.
[[nodiscard]] std::int64_t voxel_number(float p_m, double size_m) noexcept;

/// Returns the mean of the points in each occupied voxel, ordered by voxel
/// (x, then y, then z). Slabs along x, processed in order, therefore give the
/// same result as the whole cloud. Sums run in the order of the points.
/// Points must be finite, and `fits_voxels` must be true for their bounding
/// box.
[[nodiscard]] std::vector<Eigen::Vector3f> voxel_means_m(std::span<const Eigen::Vector3f> points_m,
                                                         double size_m,
                                                         Executor& executor = serial());

/// True if the voxels of a box can be numbered: at most 2^63, e.g. 1 mm voxels in a cube of 2 km.
[[nodiscard]] bool fits_voxels(const geometry::PointBox& box, double size_m);

}  // namespace surefoot::eval
