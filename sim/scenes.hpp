// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/motion.hpp"
#include "sim/motion_script.hpp"
#include "sim/scene.hpp"
#include "surefoot/core/result.hpp"

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
};

/// The scenes of sim/scenes/, which travel inside the program.
[[nodiscard]] std::vector<SceneInfo> list_scenes();

/// The seed draws the parameters of the scene, shifts its textures and moves the stops of the path
/// by about a centimetre (never the first one). `name` is one of the list, or a scene file that
/// ends in ".yaml" ("my/kerb.yaml", or "my/kerbs.yaml#kerb_low" where it holds several). An unknown
/// name is a usage error that lists the names. `carrier` goes the scene's way instead of its own
/// one; a way that it cannot go (a walking machine's steps are limited) is an error.
[[nodiscard]] Result<ScriptedScene> make_scene(const std::string& name,
                                               std::uint64_t seed,
                                               std::optional<Carrier> carrier = {});

/// Where things stand in `demo_stairs`, for tests and demonstrations (metres, world frame).
namespace demo_stairs {
inline constexpr double kRise_m = 0.18;
inline constexpr double kGoing_m = 0.31;
inline constexpr double kFirstRiser_x_m = 3.6;
inline constexpr double kStairHalfWidth_m = 0.6;
inline constexpr double kRampFoot_x_m = 2.8;
inline constexpr double kRampLength_m = 1.44;
inline constexpr double kRampCenter_y_m = -1.25;
inline constexpr double kRampWidth_m = 1.1;
inline constexpr double kTableTop_m = 0.72;
inline constexpr double kTableMin_x_m = 1.9;
inline constexpr double kTableMax_x_m = 2.9;
inline constexpr double kTableMin_y_m = 0.8;
inline constexpr double kTableMax_y_m = 1.5;
inline constexpr double kPitMin_x_m = 1.1;
inline constexpr double kPitMax_x_m = 2.4;
inline constexpr double kPitMin_y_m = -1.7;
inline constexpr double kPitMax_y_m = -0.8;
inline constexpr double kPitDepth_m = 0.25;
inline constexpr double kPathEnd_x_m = 2.4;
}  // namespace demo_stairs

namespace platform_edge {
inline constexpr double kHeight_m = 0.17;
inline constexpr double kEdge_x_m = 2.6;
/// The next step would land with half a foot beyond the edge.
inline constexpr double kPathEnd_x_m = 2.15;
}  // namespace platform_edge

}  // namespace surefoot::sim
