// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/sim/motion/motion_script.hpp"

namespace surefoot::sim {

/// Ways that a user of the machine goes every day and that are hard for a map: what they step on
/// was seen long ago, or from the side. They start at the origin of the world, looking along x.
/// Turns and steps of the rex come in whole numbers: it stops within half a step of what is asked.

/// Straight ahead to what is looked at.
[[nodiscard]] MotionScript approach_script(MotionModel motion_model, double distance_m);

/// On the spot, `turn_rad` to the left (negative: right), and back again.
[[nodiscard]] MotionScript turn_round_script(MotionModel motion_model, double turn_rad);

/// Sees a table ahead, walks to where it is `left_m` away, turns round there and walks backward to
/// it, as one does to sit down or lean against it.
[[nodiscard]] MotionScript back_to_table_script(MotionModel motion_model,
                                                double table_x_m,
                                                double left_m);

/// Sees a door ahead in a wall across x, stops before it, turns the right side back so that the
/// left one, with the camera, faces the door, and sidesteps through it until `beyond_m` behind it.
[[nodiscard]] MotionScript sidestep_through_door_script(MotionModel motion_model,
                                                        double door_x_m,
                                                        double door_y_m,
                                                        double beyond_m);

/// Where the edge of `descend_backwards_script` must be.
[[nodiscard]] double descending_edge_x_m(int steps_ahead);

/// Approaches a flight that goes down by `steps_ahead` steps, sees it, turns round, steps back to
/// the edge and with one more step onto its first tread, `riser_m` lower.
[[nodiscard]] MotionScript descend_backwards_script(int steps_ahead, double riser_m);

/// Turns by 90 deg to the left and goes back by `distance_m`: onto ground that no camera has seen
/// but in passing.
[[nodiscard]] MotionScript pivot_and_reverse_script(MotionModel motion_model, double distance_m);

}  // namespace surefoot::sim
