// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "surefoot/core/assert.hpp"

namespace surefoot::geometry {

/// A box parallel to the axes.
struct PointBox {
    Eigen::Vector3f low_m = Eigen::Vector3f::Zero();
    Eigen::Vector3f high_m = Eigen::Vector3f::Zero();
};

/// Returns the bounding box of at least one point.
[[nodiscard]] inline PointBox box_of(std::span<const Eigen::Vector3f> points_m) {
    SUREFOOT_ASSERT(!points_m.empty());
    PointBox box{points_m.front(), points_m.front()};
    for (const Eigen::Vector3f& p_m : points_m) {
        box.low_m = box.low_m.cwiseMin(p_m);
        box.high_m = box.high_m.cwiseMax(p_m);
    }
    return box;
}

}  // namespace surefoot::geometry
