// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/sim/motion/rex_gait.hpp"
#include "surefoot/sim/motion/rex_plan.hpp"
#include "surefoot/sim/scenes/primitives.hpp"

namespace surefoot::sim {

/// What a part of the REX and its user fills during its movements: a box of base_link while that
/// goes straight from start to target, and heights over the soles.
struct TracedPart {
    std::string name;
    Rect box;
    double low_m = 0.0;
    double high_m = 0.0;
};

/// Walks each movement on level ground, `seeds` times from `first_seed` on, and takes the smallest
/// boxes that hold every link at every moment (20 a second): the hull of the box at the start and
/// at the target then holds all of the way. Links are the boxes of the collision model (upper and
/// lower legs 0.15 x 0.15 m); the frame is the machine's 0.66 x 0.645 m from 0.15 m below the hips
/// to 1.30 m over the soles, the user's trunk and head 0.40 x 0.55 m above it to 2.05 m (both
/// ASSUMPTIONS: the data sheet has no drawing). Frame and user sway with the body, as the camera
/// does.
[[nodiscard]] Result<std::vector<TracedPart>> trace_body(const std::vector<RexMovement>& movements,
                                                         const RexGaitConfig& gait,
                                                         std::uint64_t first_seed,
                                                         int seeds);

}  // namespace surefoot::sim
