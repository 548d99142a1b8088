// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/sim/motion/motion_script.hpp"
#include "surefoot/sim/scenes/scene.hpp"
#include "surefoot/sim/scenes/scene_builder.hpp"
#include "surefoot/sim/scenes/scene_node.hpp"
#include "surefoot/sim/scenes/scene_reader.hpp"

namespace surefoot::sim {

/// Reads the group `motion` of a scene file: waypoints, or a script of motion_scripts.hpp by name.
[[nodiscard]] MotionScript read_motion(SceneReader& reader, const SceneNode& group);

/// Ground height for the feet of a walk that begins at z = 0: the highest surface that is at most
/// 0.25 m above the previous answer. A table top or a lintel is therefore not ground, but a ramp
/// is, however high it leads. For a block that is too high the answer is its top; without any
/// surface the answer is -1000 m. The REX can walk on neither. The scene must outlive the returned
/// function. Call it in the order of the walk.
[[nodiscard]] GroundHeight ground_of(const Scene& scene);

/// Fails if base_link or a camera on the usual mount enters a solid anywhere on the path. Also
/// fails if a foot of a walking machine is set into a solid.
void check_way(SceneReader& reader,
               const SceneNode& group,
               const SceneBuilder& builder,
               const ScriptedMotion& motion);

}  // namespace surefoot::sim
