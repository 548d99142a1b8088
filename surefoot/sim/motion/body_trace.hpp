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

/// The space that one part of the REX or of its user fills during a movement. It is a box in
/// base_link that moves straight from start to target, with its heights above the soles.
struct TracedPart {
    std::string name;
    Rect box;
    double low_m = 0.0;
    double high_m = 0.0;
};

/// Computes the smallest boxes that contain every link at every moment (20 samples a second). It
/// simulates each movement on level ground `seeds` times, with seeds from `first_seed` on. The hull
/// of the box at the start and the box at the target then contains the whole movement. Links are
/// the boxes of the collision model (upper and lower legs 0.15 x 0.15 m). Frame: the machine's 0.66
/// x 0.645 m, from 0.30 m below base_link to 1.30 m above the soles. User: trunk and head 0.40 x
/// 0.55 m above the frame, up to 2.05 m. Both sizes are ASSUMPTIONS: the data sheet has no drawing.
/// Frame and user sway with the body, as the camera does.
[[nodiscard]] Result<std::vector<TracedPart>> trace_body(const std::vector<RexMovement>& movements,
                                                         const RexGaitConfig& gait,
                                                         std::uint64_t first_seed,
                                                         int seeds);

}  // namespace surefoot::sim
