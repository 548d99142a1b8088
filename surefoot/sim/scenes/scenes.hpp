// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/sim/motion/motion.hpp"
#include "surefoot/sim/motion/motion_script.hpp"
#include "surefoot/sim/scenes/expression.hpp"
#include "surefoot/sim/scenes/scene.hpp"

namespace surefoot::sim {

struct SceneInfo {
    std::string name;
    std::string description;  ///< one line of text
};

/// A parameter value that the seed has drawn.
struct SceneParameter {
    std::string name;
    std::string value;

    friend bool operator==(const SceneParameter&, const SceneParameter&) = default;
};

/// A scene and the path through it. World frame: origin on the ground under the first base_link (z
/// = 0 on that floor, x ahead), which is also the start of odometry.
struct ScriptedScene {
    SceneInfo info;
    std::vector<SceneParameter> parameters;
    Scene scene;
    MotionScript script;
    std::shared_ptr<const Motion> motion;
    std::vector<StepEvent> steps;  ///< steps of a walking machine
    std::vector<Stop> stops;       ///< stops of a trolley
    int solids = 0;                ///< boxes, tables, flights, ... each counted once
    /// World positions of the laser scanner; empty if the file has none.
    std::vector<Eigen::Vector3d> stations_m;
};

/// The scenes of surefoot/sim/scene_files/, which are compiled into the program.
[[nodiscard]] std::vector<SceneInfo> list_scenes();

/// Builds a scene. The seed draws its parameters, shifts its textures, and moves all waypoints but
/// the first by up to 1 cm along x and y, and 0.3 deg in yaw. `name` is a listed name or a ".yaml"
/// file ("my/kerb.yaml", or "my/kerbs.yaml#kerb_low" if the file holds several). An unknown name is
/// a usage error that names the likely scene. `motion_model` replaces the model of the scene; a
/// path that this model cannot follow (a walking machine's steps are limited) is an error.
[[nodiscard]] Result<ScriptedScene> make_scene(const std::string& name,
                                               std::uint64_t seed,
                                               std::optional<MotionModel> motion_model = {});

/// A number that the seed has drawn, by its name in the scene file ("edge_x_m"); for tests and
/// experiments. Precondition: the file has a parameter of that name.
[[nodiscard]] double drawn_number(const ScriptedScene& script, std::string_view name);

/// All numbers that the scene has drawn or computed, for expressions about the scene.
[[nodiscard]] NamedNumbers drawn_numbers(const ScriptedScene& script);

/// Constants of `demo_stairs`: the staircase of the reference thesis (Lange 2016).
namespace demo_stairs {
inline constexpr double kRise_m = 0.18;
inline constexpr double kGoing_m = 0.31;
}  // namespace demo_stairs

}  // namespace surefoot::sim
