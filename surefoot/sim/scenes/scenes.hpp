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
    std::string description;  ///< one line
};

/// What the seed has drawn.
struct SceneParameter {
    std::string name;
    std::string value;

    friend bool operator==(const SceneParameter&, const SceneParameter&) = default;
};

/// A place and the way through it. The world frame is the ground under the first base_link (z = 0
/// on that floor, x ahead), which is also where odometry starts.
struct ScriptedScene {
    SceneInfo info;
    std::vector<SceneParameter> parameters;
    Scene scene;
    MotionScript script;
    std::shared_ptr<const Motion> motion;
    std::vector<StepEvent> steps;  ///< of a walking machine
    std::vector<Stop> stops;       ///< of a trolley
    int solids = 0;                ///< boxes, tables, flights, ... each counted once
    /// Where a laser scanner stands, if the file says it; world frame.
    std::vector<Eigen::Vector3d> stations_m;
};

/// The scenes of surefoot/sim/scene_files/, which travel inside the program.
[[nodiscard]] std::vector<SceneInfo> list_scenes();

/// The seed draws the parameters of the scene, shifts its textures and moves the stops of the path
/// by about a centimetre (never the first one). `name` is one of the list, or a scene file that
/// ends in ".yaml" ("my/kerb.yaml", or "my/kerbs.yaml#kerb_low" where it holds several). An unknown
/// name is a usage error that lists the names. `carrier` goes the scene's way instead of its own
/// one; a way that it cannot go (a walking machine's steps are limited) is an error.
[[nodiscard]] Result<ScriptedScene> make_scene(const std::string& name,
                                               std::uint64_t seed,
                                               std::optional<MotionModel> motion_model = {});

/// A number that the seed has drawn, by its name in the scene file ("edge_x_m"): where things
/// stand, for tests and experiments. Precondition: the file has a parameter of that name.
[[nodiscard]] double drawn_number(const ScriptedScene& script, std::string_view name);

/// All numbers that it has drawn or computed, for expressions about the scene.
[[nodiscard]] NamedNumbers drawn_numbers(const ScriptedScene& script);

/// What never varies in `demo_stairs`: the thesis' stair.
namespace demo_stairs {
inline constexpr double kRise_m = 0.18;
inline constexpr double kGoing_m = 0.31;
}  // namespace demo_stairs

}  // namespace surefoot::sim
