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

/// What carries the camera.
enum class MotionModel : std::uint8_t { trolley, rex, hand };
inline constexpr const char* kMotionModelNames[] = {"trolley", "rex", "hand"};

/// A way through a scene as its file tells it.
struct MotionScript {
    MotionModel motion_model = MotionModel::trolley;
    /// 0 = the carrier's own. Of the rex: length of a step ahead by the time that a step takes.
    double speed_m_s = 0.0;
    /// Of base_link above the ground, for a hand; 0 = its own.
    double height_m = 0.0;
    std::vector<Waypoint> waypoints;
};

/// A movement that the user asks for at some time, as the joystick sends it.
struct StepEvent {
    double start_s = 0.0;  ///< when the code is given: the machine still stands
    double end_s = 0.0;    ///< when it stands again
    int command = 0;       ///< joystick code of the machine file
    Pose T_world_before;   ///< base_link standing, level
    Pose T_world_after;
};

/// A pause of a trolley: there a movement of a machine that stood in its place can be asked for.
struct Stop {
    double start_s = 0.0;
    Pose T_world_body;
};

struct ScriptedMotion {
    std::shared_ptr<const Motion> motion;
    std::vector<StepEvent> steps = {};  ///< of a walking machine; empty for the other carriers
    std::vector<Stop> stops = {};       ///< of a trolley; a hand never stands still
};

/// The seed moves all waypoints but the first by about a centimetre and a third of a degree, and
/// chooses what is irregular about the carrier. A script that cannot be walked is a usage error.
///
/// The feet of the rex land on `ground_z_m`, asked for under the middle of each sole. Without it
/// the ground is what the waypoints say, straight between them, asked for under base_link. The
/// other carriers follow the waypoints alone.
[[nodiscard]] Result<ScriptedMotion> make_motion(const MotionScript& script,
                                                 std::uint64_t seed,
                                                 const GroundHeight& ground_z_m = {});

}  // namespace surefoot::sim
