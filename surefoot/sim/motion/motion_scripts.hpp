// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/sim/motion/motion_script.hpp"

namespace surefoot::sim {

/// Everyday paths that are hard for a map: the machine steps onto ground that the camera saw long
/// ago, from the side only, or never. Paths start at the world origin, facing +x. The REX makes
/// whole steps and turns, so that it stops within half a step of the requested place.

/// Walks straight ahead to the target that the camera sees.
[[nodiscard]] MotionScript approach_script(MotionModel motion_model, double distance_m);

/// Turns on the spot by `turn_rad` (positive: left) and back again.
[[nodiscard]] MotionScript turn_round_script(MotionModel motion_model, double turn_rad);

/// Walks to a table that is ahead until it is `left_m` away. Then turns round and walks backward to
/// it, as a user does to sit down.
[[nodiscard]] MotionScript back_to_table_script(MotionModel motion_model,
                                                double table_x_m,
                                                double left_m);

/// Sees a door ahead in a wall across x and stops before it. Turns right by 90 deg, so that the
/// left side with the camera faces the door. Sidesteps through it until `beyond_m` behind it.
[[nodiscard]] MotionScript sidestep_through_door_script(MotionModel motion_model,
                                                        double door_x_m,
                                                        double door_y_m,
                                                        double beyond_m);

/// x [m] at which a scene must place the edge for `descend_backwards_script`.
[[nodiscard]] double descending_edge_x_m(int steps_ahead);

/// Approaches a flight that goes down, by `steps_ahead` steps, sees it and turns round. Steps back
/// to the edge, then one more step onto the first tread, which is `riser_m` lower.
[[nodiscard]] MotionScript descend_backwards_script(int steps_ahead, double riser_m);

/// Turns by 90 deg to the left and walks back by `distance_m`. The ground there lies to the right
/// of the start pose, and the camera does not see it during the turn.
[[nodiscard]] MotionScript pivot_and_reverse_script(MotionModel motion_model, double distance_m);

}  // namespace surefoot::sim
