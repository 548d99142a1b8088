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

/// Randomly drawn scenes in which one movement leads into one hazard, and safe counterparts.
namespace surefoot::experiments {

enum class Hazard : std::uint8_t {
    stairs_down,
    stairs_up,
    kerb,  ///< one step of 0.04 to 0.18 m, down or up
    hole,
    platform,  ///< edge of a platform: the lower level is 0.3 to 1.2 m down, or a void
    wall,
    table,
    sill,
    unseen,  ///< one of the other hazards, in a region that the cameras did not observe
    person,  ///< drawn as an upright column
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
    /// Returns true if the solid intersects the line segment between two points.
    [[nodiscard]] bool blocks(const Eigen::Vector3d& from_m,
                              const Eigen::Vector3d& to_m) const noexcept;
};

/// A scene and a query: the machine walked `way_m` straight ahead, perhaps turned by 180 deg, and
/// now asks for one movement. World frame: z = 0 is the ground under the machine.
struct HazardScene {
    std::uint64_t seed = 0;
    Hazard asked = Hazard::kerb;  ///< kind of the scene
    Hazard thing =
        Hazard::kerb;           ///< the hazard in the scene; differs from `asked` only for `unseen`
    bool relief_only = false;   ///< true: safe scene whose relief is at most 10 mm
    int command = 0;            ///< joystick code
    double relief_m = 0.0;      ///< signed height of the hazard [m]; negative = down
    double way_m = 0.0;         ///< distance walked forward [m]
    bool turned = false;        ///< true: turned by 180 deg on the spot at the end
    std::vector<Solid> solids;  ///< objects of the scene, in the world frame
    Eigen::Vector2d edge_m = Eigen::Vector2d::Zero();  ///< a point on the near border of the hazard
    Eigen::Vector2d normal =
        Eigen::Vector2d::UnitX();  ///< direction from the near border into the hazard
    Pose T_world_body;             ///< pose of base_link at the query
    double yaw_rad = 0.0;          ///< yaw of T_world_body

    /// Returns the scene for the oracle and the simulated sensors. Each solid has its own material.
    [[nodiscard]] sim::Scene scene() const;
    /// Returns the text of a scene file for the simulator: this scene with a room around it, and
    /// the path of the machine with the trolley motion model. Only for scenes placed `on_way`.
    [[nodiscard]] std::string yaml() const;
};

/// Placement of the machine in the world frame.
enum class Placing : std::uint8_t {
    anywhere,  ///< random yaw and shift: map cells have a random position in the scene
    on_way,    ///< the path begins at the origin and leads along x, as in a pipeline run
};

/// Draws a scene from its seed. The geometry does not depend on `placing`. The movement is not
/// guaranteed to be dangerous or safe: `sim::judge` decides.
[[nodiscard]] HazardScene make_hazard_scene(
    Hazard kind, bool relief_only, std::uint64_t seed, const Machine& machine, Placing placing);

}  // namespace surefoot::experiments
