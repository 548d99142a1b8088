// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/gate/gate.hpp"

namespace surefoot::gate {

/// A pose that a person selected on the map: base_link in odom.
struct GoalPose {
    std::int64_t x_tenth_mm = 0;
    std::int64_t y_tenth_mm = 0;
    double cos_yaw = 0.0;  ///< a default goal is not a valid pose
    double sin_yaw = 0.0;
};

/// Decides whether the machine could stand at a goal, on ground that is connected to its ground
/// now. `here`: the present pose; its command is ignored. For display only: the verdict never
/// allows a step, because it expires at the time of the decision. The function does not judge the
/// path. Pure, like decide().
[[nodiscard]] Verdict judge_goal(const Machine& machine,
                                 const Query& here,
                                 const GoalPose& goal,
                                 const grid::MapSnapshot& map,
                                 const GateHealth& health,
                                 std::int64_t now_ns) noexcept;

}  // namespace surefoot::gate
