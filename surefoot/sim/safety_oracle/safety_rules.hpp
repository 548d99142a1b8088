// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "surefoot/sim/safety_oracle/safety_figures.hpp"
#include "surefoot/sim/safety_oracle/safety_oracle.hpp"
#include "surefoot/sim/scenes/ground_field.hpp"

/// The rules of the safety oracle for one exact pose; `judge` asks them again around the pose.
namespace surefoot::sim::rules {

/// The plane that both feet stand on, in the frame of the field.
struct Stance {
    LevelPlane plane;
    double height_difference_m = 0.0;  ///< between the means of the two feet, from the plane
    double tilt_rad = 0.0;             ///< of the plane or of a foot, whichever is steeper
    std::optional<Eigen::Vector2d> void_at_m;  ///< no ground under a foot: in the field's frame
    bool known = false;                        ///< there is ground under some part of both feet
};
[[nodiscard]] Stance stand(const GroundField& field,
                           const Figures& figures,
                           const PlanarPose& T_field_body);

/// All that is dangerous, one finding for each danger, sorted. `reached` says which samples are
/// joined to the ground of standing.
[[nodiscard]] std::vector<Finding> dangers_at(const GroundField& field,
                                              const std::vector<char>& reached,
                                              const Figures& figures,
                                              const PlanarPose& T_field_body);

}  // namespace surefoot::sim::rules
