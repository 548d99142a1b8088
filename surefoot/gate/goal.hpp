// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/gate/gate.hpp"

namespace surefoot::gate {

/// A place that somebody pointed at: base_link in odom.
struct GoalPose {
    std::int64_t x_tenth_mm = 0;
    std::int64_t y_tenth_mm = 0;
    double cos_yaw = 0.0;  ///< a default goal is no pose
    double sin_yaw = 0.0;
};

/// Would the machine stand there, on ground joined to where it stands now (`here`; its command is
/// not read)? A picture of the ground for people: whatever the decision, the verdict allows no
/// step, its life ends when it begins. The way there is not judged, only that the surface leads
/// there. Pure, like decide().
[[nodiscard]] Verdict judge_goal(const Machine& machine,
                                 const Query& here,
                                 const GoalPose& goal,
                                 const grid::MapSnapshot& map,
                                 const GateHealth& health,
                                 std::int64_t now_ns) noexcept;

}  // namespace surefoot::gate
