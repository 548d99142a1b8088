// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace surefoot::geometry {

/// Indices of points along a Morton curve (Morton 1966) through their box, 10 bits an axis.
/// Successive points lie near each other, so that successive searches find their data in the
/// caches. Points in one cell keep their order. Points must be finite, and fewer than 2^32 -
/// 1.
[[nodiscard]] std::vector<std::uint32_t> spatial_order(std::span<const Eigen::Vector3f> points_m);

}  // namespace surefoot::geometry
