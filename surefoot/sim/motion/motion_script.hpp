// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/sim/motion/motion.hpp"
#include "surefoot/sim/motion/trolley_motion.hpp"
#include "surefoot/sim/motion/waypoint.hpp"

namespace surefoot::sim {

/// Motion model: how the camera is carried.
enum class MotionModel : std::uint8_t { trolley, rex, hand };
inline constexpr const char* kMotionModelNames[] = {"trolley", "rex", "hand"};

/// A path through a scene, as its scene file describes it.
struct MotionScript {
    MotionModel motion_model = MotionModel::trolley;
    /// Speed; 0 = default of the motion model. For the REX: step length ahead / step duration.
    double speed_m_s = 0.0;
    /// Height of base_link above the ground, hand-held only; 0 = default of the motion model.
    double height_m = 0.0;
    std::vector<Waypoint> waypoints;
};

/// One step of the walking machine, triggered by a joystick code.
struct StepEvent {
    double start_s = 0.0;  ///< time of the joystick code; the machine still stands
    double end_s = 0.0;    ///< time from which the machine stands again
    int command = 0;       ///< joystick code of the machine file
    Pose T_world_before;   ///< base_link of the standing machine, level
    Pose T_world_after;
};

/// A pause of a trolley. A step query is possible here, as if a machine stood in its place.
struct Stop {
    double start_s = 0.0;
    Pose T_world_body;
};

struct ScriptedMotion {
    std::shared_ptr<const Motion> motion;
    std::vector<StepEvent> steps = {};  ///< only for a walking machine; empty for the other models
    std::vector<Stop> stops = {};       ///< only for a trolley; a hand-held camera drifts in pauses
};

/// Builds a motion. The seed moves all waypoints but the first by up to 1 cm along x and y, and
/// 0.3 deg in yaw, and draws small irregularities. An unwalkable script is a usage error.
///
/// The feet of the REX land on `ground_z_m`, queried under the middle of each sole. Without this
/// function the ground is linear between the waypoint heights, queried under base_link. The other
/// motion models ignore this function and follow the waypoints alone.
[[nodiscard]] Result<ScriptedMotion> make_motion(const MotionScript& script,
                                                 std::uint64_t seed,
                                                 const GroundHeight& ground_z_m = {});

}  // namespace surefoot::sim
