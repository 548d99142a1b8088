// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "surefoot/sim/safety_oracle/safety_figures.hpp"
#include "surefoot/sim/safety_oracle/safety_oracle.hpp"
#include "surefoot/sim/scenes/ground_field.hpp"

/// The rules of the safety oracle for one exact pose; `judge` also checks poses around it.
namespace surefoot::sim::rules {

/// The plane that both feet stand on, in the frame of the field.
struct Stance {
    LevelPlane plane;
    double height_difference_m = 0.0;  ///< difference of the feet's mean heights over the plane
    double tilt_rad = 0.0;             ///< tilt of the plane or of one foot, whichever is steeper
    std::optional<Eigen::Vector2d> void_at_m;  ///< a point under a foot where ground is missing
    bool known = false;                        ///< true: a part of each foot has ground
};
[[nodiscard]] Stance stand(const GroundField& field,
                           const Figures& figures,
                           const PlanarPose& T_field_body);

/// Returns the dangers at this pose, one finding for each danger, in the order of `Danger`.
/// `reached` marks the samples that are joined to the ground under the feet.
[[nodiscard]] std::vector<Finding> dangers_at(const GroundField& field,
                                              const std::vector<char>& reached,
                                              const Figures& figures,
                                              const PlanarPose& T_field_body);

}  // namespace surefoot::sim::rules
