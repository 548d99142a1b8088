// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/sim/motion/waypoint.hpp"

namespace surefoot::sim {

/// Target of one joystick code, relative to the current base_link.
struct RexMovement {
    int command = 0;  ///< code of the machine file
    double forward_m = 0.0;
    double left_m = 0.0;
    double turn_rad = 0.0;  ///< left positive
};

/// Step sizes of the machine. The reference thesis (Lange 2016) gives forward 0.35-0.40, backward
/// 0.25-0.35, sideways 0.10-0.30 m; the defaults are those of machines/rex.yaml.
struct RexStepSizes {
    double forward_m = 0.40;
    double backward_m = 0.25;
    double sideways_m = 0.10;
    double turn_deg = 15.0;
};

/// All codes of machines/rex.yaml. 9-24: sectors clockwise from ahead on the ellipse through the
/// four steps. 1-8: steps half as long. 25 and 26: turns to the left and to the right.
[[nodiscard]] std::vector<RexMovement> rex_movements(const RexStepSizes& sizes);

/// Pose of base_link of a standing machine on the floor plan.
struct RexStand {
    double x_m = 0.0;
    double y_m = 0.0;
    double yaw_rad = 0.0;
};
[[nodiscard]] RexStand moved(const RexStand& stand, const RexMovement& movement, double share);

struct RexStep {
    double wait_s = 0.0;  ///< time that the machine stands before the command
    RexMovement movement;
    RexStand before;
    RexStand after;  ///< real end of the step: a few millimetres off the commanded pose
};

struct RexPlan {
    RexStand start;
    std::vector<RexStep> steps;
    double last_wait_s = 0.0;
};

/// Plans commands through the waypoints as an operator would give them. The machine turns in place
/// toward the waypoint, or goes backward or sideways if that is shorter or requested. It repeats
/// the sector that brings it nearest. Then it turns to the waypoint's yaw. It stops within half a
/// step and half of `turn_deg`. A path of 2000 steps or more is a usage error.
[[nodiscard]] Result<RexPlan> plan_rex_steps(const std::vector<Waypoint>& waypoints,
                                             const RexStepSizes& sizes,
                                             Rng& rng);

}  // namespace surefoot::sim
