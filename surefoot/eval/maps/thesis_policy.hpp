// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/footprint.hpp"

namespace surefoot::eval {

/// Step query of the reference thesis (Lange 2016): the mean traversability under one rectangle at
/// the target of base_link, with the robot's yaw at the target. Cells without a rating and cells
/// beyond the map count as `unmapped`. For comparison only: this policy allows ground that was
/// never observed.
struct ThesisPolicy {
    double length_m = 0.20;   ///< length of the rectangle, along the robot
    double width_m = 0.40;    ///< width of the rectangle, across the robot
    double safe_mean = 0.80;  ///< least mean traversability for a step (safeTraverse)
    double unmapped = 1.0;    ///< value of unmapped cells; Lange 2016: traversability_default
};

struct ThesisAnswer {
    bool allowed = false;
    double mean = 0.0;  ///< mean of the cells whose centre lies in the rectangle; 0 without cells
    int cells = 0;
    int unmapped = 0;  ///< number of unmapped cells in the rectangle
};

/// `rating`: traversability of the cells of `geometry`, 1 to 0, NaN = unmapped. `target` is in the
/// map's frame.
[[nodiscard]] ThesisAnswer thesis_policy(const ThesisPolicy& policy,
                                         const traversability::FootprintPose& target,
                                         const grid::GridGeometry& geometry,
                                         ImageView<const float> rating);

}  // namespace surefoot::eval
