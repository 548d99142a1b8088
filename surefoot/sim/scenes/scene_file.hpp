// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/sim/scenes/scenes.hpp"

namespace surefoot::sim {

/// A scene file is YAML and holds one scene, or one geometry with several `variants` (the same
/// stairs with the figures of each class). A figure of a variant replaces the parameter of the same
/// name.
///
///     name: kerb_ahead                  # or  variants: {name: {description: ..., figure: ...}}
///     description: one line
///     parameters:                       # drawn by the seed, in this order
///       distance_m: {uniform: [1.5, 2.5]}
///       look: {choice: [concrete, patches]}
///       end_m: distance_m - 0.45        # expressions of the parameters above
///     lighting: {ambient: 0.5}          # keys of Lighting
///     materials:
///       ground: {pattern: look, albedo: 0.4}   # keys of Material
///     solids:                           # keys of the structs of solids.hpp
///       - floor: {min_x_m: -3, min_y_m: -5, max_x_m: 9, max_y_m: 5, material: ground}
///       - group: {x_m: distance_m, heading_deg: 5, solids: [...]}
///       - repeat: {count: 4, name: k, solids: [...]}      # k = 0, 1, 2, 3; count 0 = none
///       - repeat: {count: 9, name: k, parameters: {size_m: {uniform: [0.1, 0.3]}}, solids: [...]}
///     scan:                             # where a laser scanner stands, for `sim --scan`
///       stations: [{x_m: 0, y_m: 2}, {x_m: 5, y_m: 0, above_m: 1.2}]
///     motion:                           # a variant may have its own
///       motion_model: trolley                              # or rex, hand
///       waypoints: [{x_m: 0, y_m: 0, pause_s: 1}, {x_m: end_m, y_m: 0}]
///
/// Instead of waypoints a motion may name a script of motion_scripts.hpp with its figures:
///
///     motion: {motion_model: rex, script: back_to_table, table_x_m: distance_m, left_m: 0.95}
///     # approach: distance_m; turn_round: turn_deg; pivot_and_reverse: distance_m;
///     # sidestep_through_door: door_x_m, door_y_m, beyond_m;
///     # descend_backwards: steps_ahead, riser_m
///
/// The feet of the REX land on the ground of the scene.
///
/// Strict: unknown keys, wrong types, values out of range, impossible geometry, a camera or a foot
/// inside a solid, and too high steps are input errors that name file, line and problem.
struct SceneFile {
    std::string file;  ///< file name for messages
    std::string_view text;
};

/// Limit of the primitives in a scene file, because images number their surfaces in 15 bits.
inline constexpr int kMaxPrimitives = 2000;

/// Reads the names and descriptions of the scenes of a file.
[[nodiscard]] Result<std::vector<SceneInfo>> read_scene_infos(const SceneFile& file);

/// Reads one scene; `name` may be empty if the file holds only one. The random stream depends on
/// seed and scene name: seed 7 draws unrelated numbers in two scenes or variants. `motion_model`
/// replaces the model of the scene (same path, default speed and height of the new model).
[[nodiscard]] Result<ScriptedScene> read_scene(const SceneFile& file,
                                               const std::string& name,
                                               std::uint64_t seed,
                                               std::optional<MotionModel> motion_model = {});

}  // namespace surefoot::sim
