// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/sim/motion/motion_script.hpp"
#include "surefoot/sim/scenes/scene.hpp"
#include "surefoot/sim/scenes/scene_builder.hpp"
#include "surefoot/sim/scenes/scene_node.hpp"
#include "surefoot/sim/scenes/scene_reader.hpp"

namespace surefoot::sim {

/// The group `motion` of a scene file: waypoints, or one of `motion_scripts.hpp` by its name.
[[nodiscard]] MotionScript read_motion(SceneReader& reader, const SceneNode& group);

/// The ground of a scene for the feet of a walk that begins at z = 0: the highest surface that is
/// not above a foot's reach from the ground of the last answer. So a table top or a lintel is none,
/// but a ramp is, however far up it leads. A block that is too high is its top; where nothing is,
/// the ground is 1000 m deep: neither can be walked. The scene must outlive the answer; questions
/// must follow the walk.
[[nodiscard]] GroundHeight ground_of(const Scene& scene);

/// Fails where base_link or a camera of the usual mount comes into a solid, anywhere on the way, or
/// where a foot of a walking machine is set into one.
void check_way(SceneReader& reader,
               const SceneNode& group,
               const SceneBuilder& builder,
               const ScriptedMotion& motion);

}  // namespace surefoot::sim
