// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "surefoot/gate/regions.hpp"

namespace surefoot::gate {

/// The tread that carries the ankle of a landing foot, as movements of class stair want it: a foot
/// of 0.37 m never fits a tread of 0.3 m whole. Lengths along the foot count forward from its
/// middle and are doubled, so that a cell's middle is exact.
struct Tread {
    static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();

    bool known = false;              ///< every cell under the ankle is
    std::int64_t rise_tenth_mm = 0;  ///< over the stance, mean of the cells under the ankle
    /// Where the first cell begins that lies a drop lower than the tread, seen from the ankle
    /// towards the toes and towards the heel (there counted backward). kNone: nowhere in the band.
    std::int64_t toe_edge = kNone;
    std::int64_t heel_edge = kNone;
    std::int64_t drift_tenth_mm = 0;  ///< largest of the cells of the band
};

/// Under the left and the right foot where they land.
using Treads = std::array<Tread, 2>;
[[nodiscard]] Treads find_treads(const Scene& scene) noexcept;

/// How much higher than now the body stands at the target; 0 where it goes down.
[[nodiscard]] std::int64_t lift_of(const Treads& treads) noexcept;

/// Where the machine goes down its body passes what it stood on: at the target nothing stands as
/// high over the treads as a part of the body begins.
void check_body_lowered(const Scene& scene, const Treads& treads, Findings& findings) noexcept;

/// The drop bands of landing feet, for treads. As check_bands, but: heights count from the tread;
/// nothing within the foot's margin and drift stands higher than `swing_clearance` over it; at one
/// end of the foot, and beyond no part of the ankle, ground may lie lower by as much as the class
/// steps down, sure by `sigma_factor` sigma: the next tread. Unknown ground is no tread. Both feet
/// land at one height.
void check_tread_bands(const Scene& scene, const Treads& treads, Findings& findings) noexcept;

/// Ground under one landing foot:
/// 1. The tread ends where the first lower cell begins, less what may be wrong about that place:
///    one cell, because the map shows things up to a cell beside their place (or, where the
///    snapshot knows the nosing as a line, `sigma_factor` sigma of its place if that is less), and
///    `sigma_factor` times the drift.
/// 2. What is left carries the ankle and at least `tread_share` of the foot, and no end hangs over
///    by more than `tread_overhang`: else SUPPORT_AREA, or EDGE_MARGIN if it does so only where the
///    edge lies just where it seems to.
/// 3. That part of the foot stands as a whole foot does on flat ground (check_landing).
void check_tread(const Scene& scene,
                 const FootSweep& foot,
                 const GroundBox& box,
                 const Tread& tread,
                 const ReachableSurfaces& reachable,
                 Findings& findings) noexcept;

/// Adds the surfaces that begin in the way of a foot within two cells of one that is `reachable`,
/// no farther up or down than the class steps: one step, not a flight.
void add_a_step_away(const Scene& scene, ReachableSurfaces& reachable) noexcept;

}  // namespace surefoot::gate
