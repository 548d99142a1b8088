// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/geometry/kd_tree.hpp"

namespace surefoot::eval {

/// Returns the distance [m] from each compared point to the nearest *point* of the reference (C2C,
/// cloud to cloud), in the order of `compared_m`. Points must be finite, and the reference must not
/// be empty. Even two clouds of one surface differ by about the point spacing of the reference.
[[nodiscard]] std::vector<float> cloud_distances_m(const geometry::KdTree& reference,
                                                   std::span<const Eigen::Vector3f> compared_m,
                                                   Executor& executor = serial());

/// Statistics of distances. NaN values are left out; without values all fields but count are NaN.
struct DistanceFigures {
    std::int64_t count = 0;
    double mean_m = 0.0;
    double std_m = 0.0;  ///< standard deviation, divisor n
    double rms_m = 0.0;
    double least_m = 0.0;
    double most_m = 0.0;
    double p50_m = 0.0;  ///< percentile of the signed values, linear between ranks
    double p90_m = 0.0;
    double p99_m = 0.0;
    double median_abs_m = 0.0;
    double p90_abs_m = 0.0;
};
[[nodiscard]] DistanceFigures distance_figures(std::span<const float> distances_m);

}  // namespace surefoot::eval
