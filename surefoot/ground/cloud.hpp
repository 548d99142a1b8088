// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "surefoot/ground/ground_config.hpp"

namespace surefoot::ground {

/// Points relative to the sensor.
struct Cloud {
    std::vector<Eigen::Vector3d> points;
    std::vector<double> inverse_range_sigma;  ///< see FramePoints; empty = not known
    std::vector<double> tolerance_m;          ///< limit of the distance from a plane; may be empty
    double band_m = 0.0;                      ///< a point farther from a plane is not on it
    Eigen::Vector3d base = Eigen::Vector3d::Zero();  ///< point whose height is wanted

    [[nodiscard]] bool knows_noise() const { return !inverse_range_sigma.empty(); }

    /// Removes the points for which `wanted(index)` is false.
    template <typename Wanted>
    void keep_if(const Wanted& wanted) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!wanted(i)) continue;
            points[kept] = points[i];
            if (!inverse_range_sigma.empty()) inverse_range_sigma[kept] = inverse_range_sigma[i];
            if (!tolerance_m.empty()) tolerance_m[kept] = tolerance_m[i];
            ++kept;
        }
        points.resize(kept);
        if (!inverse_range_sigma.empty()) inverse_range_sigma.resize(kept);
        if (!tolerance_m.empty()) tolerance_m.resize(kept);
    }
};

/// Returns the chosen points relative to `sensor`, with their sigmas if there are any.
[[nodiscard]] Cloud cloud_of(std::span<const Eigen::Vector3d> points,
                             std::span<const double> inverse_range_sigma,
                             const Eigen::Vector3d& sensor,
                             std::span<const std::size_t> chosen);

/// Sets the band: half of the config's `tolerance_m`, or 3 sigma of the most precise 10 % of the
/// points if that is more. Sets the tolerance of each point to a level plane. Removes the points
/// that are too noisy for the band. Only for clouds with known noise.
void judge_noise(const GroundConfig& config, const Eigen::Vector3d& up, Cloud& cloud);

}  // namespace surefoot::ground
