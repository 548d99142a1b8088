// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "surefoot/gate/regions.hpp"

namespace surefoot::gate {

/// The tread under the ankle of a landing foot, for movements of class stair. A foot of 0.37 m does
/// not fit wholly on a tread of 0.3 m. Positions along the foot count forward from its middle and
/// are doubled, so that cell centres are exact integers.
struct Tread {
    static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();

    bool known = false;              ///< every cell under the ankle is known
    std::int64_t rise_tenth_mm = 0;  ///< mean height of the ankle cells above the stance
    /// End of the tread: the first cell more than `drop` lower begins, or a cell with drop evidence
    /// ends. `heel_edge` counts backward from the middle of the foot. kNone: no end in the band.
    std::int64_t toe_edge = kNone;
    std::int64_t heel_edge = kNone;
    std::int64_t drift_tenth_mm = 0;  ///< largest drift of the cells of the band
};

/// Tests that both ankles stand on one tread: under them no cell lies more than `drop` below or
/// above the stance. The rest of a foot may hang over the nosing.
void check_stance_on_treads(const Scene& scene, Findings& findings) noexcept;

/// Treads under the left and the right landing foot.
using Treads = std::array<Tread, 2>;
[[nodiscard]] Treads find_treads(const Scene& scene) noexcept;

/// Rise of the body at the target above its present height; 0 for a movement down.
[[nodiscard]] std::int64_t lift_of(const Treads& treads) noexcept;

/// Tests the body at its lower height, for a movement down. At the target, no known cell below a
/// part of the body may be higher than its lower edge. Heights count from the lower tread.
void check_body_lowered(const Scene& scene, const Treads& treads, Findings& findings) noexcept;

/// Tests the drop bands of landing feet on treads. Differs from check_bands: heights count from the
/// tread. Nothing within the foot's margin and drift may be higher than `swing_clearance` above the
/// tread. At one end of the foot, outside the ankle, the ground may be lower by one step down of
/// the class, if it keeps this limit by `sigma_factor` sigma. Unknown ground does not count as a
/// tread. Both feet must land at one height (within `patch_residual`).
void check_tread_bands(const Scene& scene, const Treads& treads, Findings& findings) noexcept;

/// Tests the ground under one landing foot on a tread:
/// 1. The tread ends where the first lower cell begins, minus an uncertainty: one cell, because the
///    map can show objects up to a cell beside their position, plus `sigma_factor` times the drift.
///    If the snapshot has a line for the nosing, `sigma_factor` sigma of the line can replace the
///    cell: the smaller of the two counts.
/// 2. This tread carries the ankle and at least `tread_share` of the foot. No end overhangs by more
///    than `tread_overhang`. Otherwise SUPPORT_AREA, or EDGE_MARGIN if only the uncertainty breaks
///    the rule.
/// 3. The part of the foot on the tread passes the rules of flat ground (check_landing).
void check_tread(const Scene& scene,
                 const FootSweep& foot,
                 const GroundBox& box,
                 const Tread& tread,
                 const ReachableSurfaces& reachable,
                 Findings& findings) noexcept;

/// Adds the surfaces that begin in the path of a foot within two cells of a `reachable` surface and
/// at most one step of the class higher or lower. It does so once, so no whole flight is added.
void add_a_step_away(const Scene& scene, ReachableSurfaces& reachable) noexcept;

}  // namespace surefoot::gate
