// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "surefoot/core/pose.hpp"

namespace surefoot::calibration {

/// Returns the median of repeated estimates of one pose, per coordinate of the position and of the
/// rotation vector relative to the median itself. Needs at least one pose.
[[nodiscard]] Pose median_pose(std::span<const Pose> poses);

/// Difference between two poses.
struct PoseDistance {
    double translation_m = 0.0;
    double rotation_rad = 0.0;
};
[[nodiscard]] PoseDistance distance(const Pose& a, const Pose& b);

}  // namespace surefoot::calibration
