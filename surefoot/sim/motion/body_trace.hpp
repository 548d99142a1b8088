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

/// Computes a small box for each part. Moved from start to target, the box passes over the part at
/// every sample. The function simulates each movement on level ground `seeds` times, with seeds
/// from `first_seed` on, and takes 20 samples a second. Leg boxes: those of the collision model,
/// 0.15 m wide and deep. Frame: the machine's 0.66 x 0.645 m, from 0.30 m below base_link to
/// 1.30 m above the soles. User: trunk and head 0.40 x 0.55 m above the frame, up to 2.05 m. Frame
/// and user are ASSUMPTIONS, because the data sheet has no drawing. Both sway with the body, as the
/// camera does.
[[nodiscard]] Result<std::vector<TracedPart>> trace_body(const std::vector<RexMovement>& movements,
                                                         const RexGaitConfig& gait,
                                                         std::uint64_t first_seed,
                                                         int seeds);

}  // namespace surefoot::sim
