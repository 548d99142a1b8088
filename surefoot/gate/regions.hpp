// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "surefoot/gate/findings.hpp"
#include "surefoot/gate/footprints.hpp"
#include "surefoot/gate/ground.hpp"

namespace surefoot::gate {

/// What all tests of the terrain share.
struct Scene {
    const Machine& machine;
    const Movement& movement;
    const Ground& ground;
    const Sweep& sweep;
    std::int64_t stance_tenth_mm = 0;  ///< odom z of the ground under the present feet
    /// The same under each foot by itself, where any of it is known.
    std::array<std::optional<std::int64_t>, 2> foot_stance_tenth_mm{};
    std::int64_t lift_tenth_mm = 0;  ///< how much higher the body stands at the target
};

/// A finding at a cell.
[[nodiscard]] Finding finding_at(std::int64_t ix,
                                 std::int64_t iy,
                                 Foot foot,
                                 std::int64_t value_tenth_mm,
                                 std::int64_t limit_tenth_mm) noexcept;

/// Heights of the ground under the present feet, the means of all known cells there; nothing where
/// no cell is known.
struct StanceHeights {
    std::optional<std::int64_t> both_tenth_mm;  ///< told by the query, if it tells
    std::array<std::optional<std::int64_t>, 2> feet_tenth_mm;
};
[[nodiscard]] StanceHeights stance_heights(const Ground& ground,
                                           const Query& query,
                                           const Sweep& sweep) noexcept;

/// Surfaces under the present feet, as far as they lie at the height of the stance, and those that
/// the vouched area touches.
[[nodiscard]] ReachableSurfaces surfaces_of_stance(const Scene& scene) noexcept;

/// The four regions of safety.md 7 (4). In each every cell must be inside the map, known (or
/// vouched), surer than `cell_sigma` and not drifted more than `drift`. Where a limit counts in
/// millimetres, the height must keep it by `sigma_factor` sigma, else NOT_RESOLVABLE. A single cell
/// may be less sure, never higher or lower, when each of the eight around it passes: it has just
/// refused a wrong match, and its neighbours know.
/// - under the present feet none is a drop;
void check_stance(const Scene& scene, Findings& findings) noexcept;
/// - in the way of a foot nothing stands higher over the stance than `swing_clearance`, nor hangs
///   so low that a lifted foot meets it;
void check_corridors(const Scene& scene, Findings& findings) noexcept;
/// - in the way of each part of the body nothing stands higher than its lower edge, nor hangs lower
///   than its top;
void check_body(const Scene& scene, Findings& findings) noexcept;
/// - under and `drop_band` around the landing feet nothing lies lower than `drop` or shows evidence
///   of a drop.
void check_bands(const Scene& scene, Findings& findings) noexcept;

}  // namespace surefoot::gate
