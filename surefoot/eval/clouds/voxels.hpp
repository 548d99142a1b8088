// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/geometry/point_box.hpp"

namespace surefoot::eval {

/// One axis of a voxel lattice: borders lie on multiples of its size.
[[nodiscard]] std::int64_t voxel_number(float p_m, double size_m) noexcept;

/// One point for each voxel that holds some: their mean. In the order of the voxels (x, then y,
/// then z), so that slabs along x one behind the other give what the whole gives; the sums are
/// taken in the order of the points. Points must be finite.
///
/// The voxels of their box must have numbers (`fits_voxels`).
[[nodiscard]] std::vector<Eigen::Vector3f> voxel_means_m(std::span<const Eigen::Vector3f> points_m,
                                                         double size_m,
                                                         Executor& executor = serial());

/// Can the voxels of a box be numbered? 2^63 can: those of a millimetre in a cube of 2 km.
[[nodiscard]] bool fits_voxels(const geometry::PointBox& box, double size_m);

}  // namespace surefoot::eval
