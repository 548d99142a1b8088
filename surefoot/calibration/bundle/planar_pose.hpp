// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "surefoot/core/pose.hpp"

namespace surefoot::calibration {

/// Pose of a flat board whose points (z = 0) appear along `rays`, by the direct linear transform
/// between the plane and the rays (Hartley and Zisserman 2004, section 4.1), orthonormalised. Rays
/// may point anywhere, beyond 90 deg too. A start for a refinement, not an optimum. Nothing for
/// fewer than four points, points on a line, or rays that no plane in front could cause.
[[nodiscard]] std::optional<Pose> planar_pose(std::span<const Eigen::Vector3d> points_board_m,
                                              std::span<const Eigen::Vector3d> rays_camera);

/// Whether all points lie on a line (or one point, or none).
[[nodiscard]] bool collinear(std::span<const Eigen::Vector3d> points_board_m);

}  // namespace surefoot::calibration
