// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

namespace surefoot::sim {

/// How a walking machine approaches a waypoint; the other motion models ignore it.
enum class Move : std::uint8_t { automatic, ahead, back, side };
inline constexpr const char* kMoveNames[] = {"auto", "ahead", "back", "side"};

/// A pose on the ground, and the pause of the camera at this pose.
struct Waypoint {
    double x_m = 0.0;
    double y_m = 0.0;
    double yaw_rad = 0.0;
    double pause_s = 0.0;
    double ground_z_m = 0.0;      ///< height of the ground at this point
    Move move = Move::automatic;  ///< automatic = the way with the fewest steps
};

/// Height of the ground at a point of the world.
using GroundHeight = std::function<double(double x_m, double y_m)>;

}  // namespace surefoot::sim
