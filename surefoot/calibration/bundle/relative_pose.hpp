// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "surefoot/core/pose.hpp"

namespace surefoot::calibration {

/// Returns the median of one or more poses. Position: the median of each coordinate. Rotation: the
/// rotation vectors from the result to the poses have the median 0 in each coordinate.
[[nodiscard]] Pose median_pose(std::span<const Pose> poses);

/// Difference between two poses.
struct PoseDistance {
    double translation_m = 0.0;
    double rotation_rad = 0.0;
};
[[nodiscard]] PoseDistance distance(const Pose& a, const Pose& b);

}  // namespace surefoot::calibration
