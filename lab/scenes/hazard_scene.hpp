// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "surefoot/core/machine.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/sim/scenes/scene.hpp"

/// Scenes in which one movement leads into one hazard, and the same without it.
namespace surefoot::experiments {

enum class Hazard : std::uint8_t {
    stairs_down,
    stairs_up,
    kerb,  ///< down or up
    hole,
    platform,  ///< the lower level 0.3 to 1.2 m down, or a void
    wall,
    table,
    sill,
    unseen,  ///< one of the others, where the machine has never looked
    person,  ///< an upright column
};
inline constexpr int kHazards = 10;
inline constexpr const char* kHazardNames[] = {"stairs_down",
                                               "stairs_up",
                                               "kerb",
                                               "hole",
                                               "platform",
                                               "wall",
                                               "table",
                                               "sill",
                                               "unseen",
                                               "person"};

/// An upright solid with a flat top: a box, or a cylinder of `size_m.x()` diameter.
struct Solid {
    bool round = false;
    Eigen::Vector2d center_m = Eigen::Vector2d::Zero();
    Eigen::Vector2d size_m = Eigen::Vector2d::Zero();
    double cos_yaw = 1.0;
    double sin_yaw = 0.0;
    double bottom_m = 0.0;
    double top_m = 0.0;

    [[nodiscard]] bool covers(const Eigen::Vector2d& p_m) const noexcept;
    /// Does it stand in the way from one point to another?
    [[nodiscard]] bool blocks(const Eigen::Vector3d& from_m,
                              const Eigen::Vector3d& to_m) const noexcept;
};

/// A machine that walked `way_m` straight ahead, perhaps turned round, and now wants to make one
/// movement. World: z = 0 is the ground under it.
struct HazardScene {
    std::uint64_t seed = 0;
    Hazard asked = Hazard::kerb;  ///< the kind of scene
    Hazard thing = Hazard::kerb;  ///< what stands there: differs for `unseen`
    bool relief_only = false;     ///< at most 10 mm of relief where the hazard would be
    int command = 0;              ///< joystick code
    double relief_m = 0.0;        ///< of the hazard, signed: negative goes down
    double way_m = 0.0;           ///< walked ahead, looking ahead
    bool turned = false;          ///< half a turn on the spot at the end of the way
    std::vector<Solid> solids;    ///< world
    Eigen::Vector2d edge_m = Eigen::Vector2d::Zero();   ///< a point on the near border of the thing
    Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  ///< into it
    Pose T_world_body;                                  ///< base_link where it stands now
    double yaw_rad = 0.0;                               ///< of that

    /// The scene for the oracle and the simulator's sensors; every solid has a look of its own.
    [[nodiscard]] sim::Scene scene() const;
    /// The same as a file for the simulator, with a room around it and the machine's way on a
    /// trolley. Only for scenes placed `on_way`.
    [[nodiscard]] std::string yaml() const;
};

/// Where the machine's end of the way is put in the world.
enum class Placing : std::uint8_t {
    anywhere,  ///< random yaw and shift: how the cells of a map lie to it
    on_way,    ///< as a run of the chain has it: the way begins at the origin along x
};

/// Draws a scene from its seed; the geometry does not depend on `placing`. It may turn out harmless
/// or borderline: ask the oracle.
[[nodiscard]] HazardScene make_hazard_scene(
    Hazard kind, bool relief_only, std::uint64_t seed, const Machine& machine, Placing placing);

}  // namespace surefoot::experiments
