// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/features.hpp"

#include <cmath>
#include <cstddef>

namespace surefoot::stairs {

const char* to_string(SideKind kind) {
    constexpr const char* kNames[] = {"unknown", "wall", "level", "open"};
    return kNames[static_cast<std::size_t>(kind)];
}

LineFeature line_feature(const Edge& edge, bool goes_down) {
    const Eigen::Vector2d way = goes_down ? edge.down() : Eigen::Vector2d(-edge.down());
    LineFeature feature;
    feature.pose.p_m << edge.middle_m(), goes_down ? edge.upper_m : edge.lower_m;
    feature.pose.yaw_rad = std::atan2(way.y(), way.x());
    feature.height_m = goes_down ? -edge.height_m() : edge.height_m();
    feature.length_m = edge.length_m();
    feature.sigma_m = edge.height_sigma_m;
    feature.across_sigma_m = edge.across_sigma_m;
    feature.bottom_seen = edge.lower_seen;
    feature.log_step_ratio = edge.log_step_ratio;
    feature.tracked = edge.tracked;
    return feature;
}

}  // namespace surefoot::stairs
