// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "surefoot/gate/findings.hpp"
#include "surefoot/gate/footprints.hpp"
#include "surefoot/gate/ground.hpp"

namespace surefoot::gate {

/// Input that all terrain tests share.
struct Scene {
    const Machine& machine;
    const Movement& movement;
    const Ground& ground;
    const Sweep& sweep;
    std::int64_t stance_tenth_mm = 0;  ///< odom z of the ground under the present feet
    /// Odom z of the ground under each foot alone; empty if no cell there is known.
    std::array<std::optional<std::int64_t>, 2> foot_stance_tenth_mm{};
    std::int64_t lift_tenth_mm = 0;  ///< rise of the body on its way to the target; 0 if it sinks
};

/// Makes a finding at a cell.
[[nodiscard]] Finding finding_at(std::int64_t ix,
                                 std::int64_t iy,
                                 Foot foot,
                                 std::int64_t value_tenth_mm,
                                 std::int64_t limit_tenth_mm) noexcept;

/// Heights of the ground under the present feet: means of the known cells. Empty if no cell is
/// known.
struct StanceHeights {
    std::optional<std::int64_t> both_tenth_mm;  ///< from the query if its source is `given`
    std::array<std::optional<std::int64_t>, 2> feet_tenth_mm;
};
[[nodiscard]] StanceHeights stance_heights(const Ground& ground,
                                           const Query& query,
                                           const Sweep& sweep) noexcept;

/// Returns the surfaces under the present feet at the height of the stance, and the surfaces that
/// touch the attested area.
[[nodiscard]] ReachableSurfaces surfaces_of_stance(const Scene& scene) noexcept;

/// Tests of the four kinds of region. Every cell must lie inside the map and be known (measured or
/// attested). Its sigma must be at most `cell_sigma`, and its drift at most `drift`. If a cell
/// keeps a height limit, but not by `sigma_factor` sigma, the reason is NOT_RESOLVABLE. A single
/// cell may have up to twice `cell_sigma` if its eight neighbours pass, because wrong matches that
/// the map rejects raise the sigma of a cell.
/// - check_stance: no cell under the present feet is a drop.
void check_stance(const Scene& scene, Findings& findings) noexcept;
/// - check_corridors: nothing in the path of a foot is higher above the stance than
///   `swing_clearance` (on stairs plus one step up), or hangs so low that a lifted foot touches it.
void check_corridors(const Scene& scene, Findings& findings) noexcept;
/// - check_body: nothing in the path of a part of the body is higher than its lower edge, or hangs
///   lower than its top.
void check_body(const Scene& scene, Findings& findings) noexcept;
/// - check_bands: under the landing feet and within `drop_band` around them, no cell lies more than
///   `drop` below the stance, and no cell low enough for a foot has drop evidence.
void check_bands(const Scene& scene, Findings& findings) noexcept;

}  // namespace surefoot::gate
