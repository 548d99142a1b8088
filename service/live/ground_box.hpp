// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "surefoot/core/machine.hpp"
#include "surefoot/core/pose.hpp"

namespace surefoot::app {

/// The gate's unit of length, 0.1 mm.
inline constexpr double kTenthMm_m = 1e-4;

/// Returns the corners of a box on the ground in the odom frame [m].
[[nodiscard]] std::vector<Eigen::Vector2d> box_outline(const GroundBox& box,
                                                       const Pose& T_odom_body);

}  // namespace surefoot::app
