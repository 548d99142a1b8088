// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/footprint.hpp"

namespace surefoot::eval {

/// How the thesis' step query decided (Lange 2016): the mean traversability under one rectangle at
/// the target of base_link, with the yaw that the robot has there. Cells without a rating, and
/// those beyond the map, count as `unmapped`. For comparison only: it allows ground that nobody has
/// seen.
struct ThesisPolicy {
    double length_m = 0.20;   ///< of the rectangle, along the robot
    double width_m = 0.40;    ///< across
    double safe_mean = 0.80;  ///< allowed from here on (safeTraverse)
    double unmapped = 1.0;    ///< traversability_default of its configuration
};

struct ThesisAnswer {
    bool allowed = false;
    double mean = 0.0;  ///< of all cells whose middle lies under the rectangle; 0 without any
    int cells = 0;
    int unmapped = 0;  ///< of these
};

/// `rating`: traversability of the cells of `geometry`, 1 to 0, NaN = unmapped. `target` in the
/// frame of the map.
[[nodiscard]] ThesisAnswer thesis_policy(const ThesisPolicy& policy,
                                         const traversability::FootprintPose& target,
                                         const grid::GridGeometry& geometry,
                                         ImageView<const float> rating);

}  // namespace surefoot::eval
