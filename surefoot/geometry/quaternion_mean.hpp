// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>

namespace surefoot::geometry {

/// Mean rotation after Markley, Cheng, Crassidis and Oshman 2007 ("Averaging Quaternions", eq.
/// 12): the largest eigenvector of the weighted sum of q q^T. It minimises the weighted sum of
/// squared attitude differences. The signs of the inputs do not matter: q and -q are the same
/// rotation.
///
/// `rotations` are unit quaternions. `weights` (>= 0): one per rotation, or empty for equal
/// weights. The result has w >= 0. Returns nullopt if no weight is positive, a weight is negative,
/// a value is not finite, or the mean is not unique (two rotations half a turn apart).
[[nodiscard]] std::optional<Eigen::Quaterniond> quaternion_mean(
    std::span<const Eigen::Quaterniond> rotations, std::span<const double> weights = {});

}  // namespace surefoot::geometry
