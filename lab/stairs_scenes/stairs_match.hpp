// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "lab/stairs_scenes/stairs_observation.hpp"
#include "surefoot/stairs/features.hpp"

/// Finds the detected feature that belongs to the true feature of a scene.
namespace surefoot::experiments {

inline constexpr double kNear_m = 0.1;    ///< largest distance across the true edge
inline constexpr double kBeside_m = 1.0;  ///< largest distance between the edge middles
inline constexpr double kTurn_rad = 10.0 / 180.0 * std::numbers::pi;  ///< largest yaw error

/// Returns the yaw of the found feature minus the true yaw, in [-pi, pi].
inline double turned_rad(const stairs::FeaturePose& found, const TrueFeature& truth) {
    return std::remainder(found.yaw_rad - truth.yaw_rad, 2.0 * std::numbers::pi);
}

/// Returns the distance from the true middle to the found edge line, along the found yaw. Positive
/// = the found line is farther.
inline double across_m(const stairs::FeaturePose& found, const TrueFeature& truth) {
    const Eigen::Vector2d way(std::cos(found.yaw_rad), std::sin(found.yaw_rad));
    return way.dot(found.p_m.head<2>() - truth.middle_m);
}

/// Returns true if the found edge is within all three limits of the true edge.
inline bool is_line_of(const stairs::FeaturePose& found, const TrueFeature& truth) {
    return (found.p_m.head<2>() - truth.middle_m).norm() < kBeside_m &&
           std::abs(across_m(found, truth)) < kNear_m &&
           std::abs(turned_rad(found, truth)) < kTurn_rad;
}

/// Returns the feature with the smallest |across_m| among those that `matches` accepts, or nullptr.
template <typename Feature, typename Matches>
const Feature* nearest(const std::vector<Feature>& features,
                       const TrueFeature& truth,
                       const Matches& matches) {
    const Feature* best = nullptr;
    for (const Feature& feature : features) {
        if (!matches(feature)) continue;
        if (best == nullptr ||
            std::abs(across_m(feature.pose, truth)) < std::abs(across_m(best->pose, truth))) {
            best = &feature;
        }
    }
    return best;
}

}  // namespace surefoot::experiments
