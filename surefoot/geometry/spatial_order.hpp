// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace surefoot::geometry {

/// Indices of points along a Morton curve (Morton 1966) through their box, 10 bits an axis: points
/// that follow each other are near each other, so that searches one after the other find in the
/// caches what they need. Points in one cell keep their order. Points must be finite, and fewer
/// than 2^32.
[[nodiscard]] std::vector<std::uint32_t> spatial_order(std::span<const Eigen::Vector3f> points_m);

}  // namespace surefoot::geometry
