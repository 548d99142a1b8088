// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "surefoot/core/pose.hpp"

namespace surefoot::calibration {

/// Median of poses that should be the same one: of each coordinate of the position, and of each
/// coordinate of the rotation vector away from the median itself. At least one pose.
[[nodiscard]] Pose median_pose(std::span<const Pose> poses);

/// Distance of one pose from another.
struct PoseDistance {
    double translation_m = 0.0;
    double rotation_rad = 0.0;
};
[[nodiscard]] PoseDistance distance(const Pose& a, const Pose& b);

}  // namespace surefoot::calibration
