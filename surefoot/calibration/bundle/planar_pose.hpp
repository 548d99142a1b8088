// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "surefoot/core/pose.hpp"

namespace surefoot::calibration {

/// Returns T_camera_board of a flat board whose points (z = 0) appear along `rays_camera`, as a
/// start value. Uses the direct linear transform (Hartley and Zisserman 2004, section 4.1) and
/// makes its rotation orthonormal. A ray may be more than 90 deg off the axis. Returns nullopt for
/// fewer than four points, for points on a line, or if the transform contains no rotation.
[[nodiscard]] std::optional<Pose> planar_pose(std::span<const Eigen::Vector3d> points_board_m,
                                              std::span<const Eigen::Vector3d> rays_camera);

/// True if all points lie on one line; also for one point or no points.
[[nodiscard]] bool collinear(std::span<const Eigen::Vector3d> points_board_m);

}  // namespace surefoot::calibration
