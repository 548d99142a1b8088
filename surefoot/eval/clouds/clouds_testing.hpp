// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "surefoot/core/rng.hpp"

namespace surefoot::eval::testing {

using Points = std::vector<Eigen::Vector3f>;

/// Point cloud of a floor and three steps with risers (0.17 m by 0.285 m, 0.8 m wide), as a scanner
/// with 2 mm noise measures it.
inline Points steps(std::size_t count, std::uint64_t seed) {
    constexpr double kRiser_m = 0.17;
    constexpr double kGoing_m = 0.285;
    constexpr double kNoise_m = 0.002;
    Rng rng(seed);
    Points points_m;
    while (points_m.size() < count) {
        const auto step = static_cast<double>(rng.below(4));
        double x_m = kGoing_m * step;
        double z_m = kRiser_m * step;
        if (rng.below(3) == 0) {
            z_m -= kRiser_m * rng.uniform();
        } else {
            x_m += kGoing_m * rng.uniform();
        }
        points_m.emplace_back(static_cast<float>(x_m + kNoise_m * rng.normal()),
                              static_cast<float>(0.8 * rng.uniform()),
                              static_cast<float>(z_m + kNoise_m * rng.normal()));
    }
    return points_m;
}

}  // namespace surefoot::eval::testing
