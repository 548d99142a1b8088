// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>

namespace surefoot::geometry {

/// Mean rotation after Markley, Cheng, Crassidis and Oshman 2007 ("Averaging Quaternions", eq. 12):
/// the largest eigenvector of the weighted sum of q q^T. It minimises the weighted sum of squared
/// attitude differences and does not care about the signs of its inputs, since q and -q are one
/// rotation.
///
/// `rotations` are unit quaternions; `weights` (>= 0) are as many, or empty for equal ones. The
/// result has w >= 0. Nothing if there is no rotation with a positive weight, if a value is not
/// finite or negative, or if the mean is not unique (two rotations half a turn apart).
[[nodiscard]] std::optional<Eigen::Quaterniond> quaternion_mean(
    std::span<const Eigen::Quaterniond> rotations, std::span<const double> weights = {});

}  // namespace surefoot::geometry
