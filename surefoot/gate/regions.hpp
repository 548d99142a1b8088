// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/gate/findings.hpp"
#include "surefoot/gate/footprints.hpp"
#include "surefoot/gate/ground.hpp"
#include "surefoot/gate/stance.hpp"

namespace surefoot::gate {

/// Input that all terrain tests share.
struct Scene {
    const Machine& machine;
    const Movement& movement;
    const Ground& ground;
    const Sweep& sweep;
    Stance stance{};
    std::int64_t lift_tenth_mm = 0;  ///< rise of the body on its way to the target; 0 if it sinks
};

/// Makes a finding at a cell.
[[nodiscard]] Finding finding_at(std::int64_t ix,
                                 std::int64_t iy,
                                 Foot foot,
                                 std::int64_t value_tenth_mm,
                                 std::int64_t limit_tenth_mm) noexcept;

/// Returns the surfaces under the present feet at the height of the stance, and the surfaces that
/// touch the attested area.
[[nodiscard]] ReachableSurfaces surfaces_of_stance(const Scene& scene) noexcept;

/// Tests of the kinds of region. Heights count from the plane of the stance. Except below the
/// body, every cell must lie inside the map and be known (measured or attested). The drift of a
/// known cell must be at most `drift`, and its sigma at most `cell_sigma` (not below the body). If
/// a cell keeps a height limit, but not by `sigma_factor` sigma, the reason is NOT_RESOLVABLE. A
/// single cell may have up to twice `cell_sigma` if its eight neighbours pass, because wrong
/// matches that the map rejects raise the sigma of a cell.
/// - check_stance: no cell under the present feet is a drop.
void check_stance(const Scene& scene, Findings& findings) noexcept;
/// - check_corridors: nothing in the path of a foot is higher above the stance than
///   `swing_clearance` (on stairs plus the rise of the body), or hangs so low that a lifted foot
///   touches it.
void check_corridors(const Scene& scene, Findings& findings) noexcept;
/// - check_body: nothing in the path of a part of the body is higher than its lower edge, or hangs
///   lower than its top. A cell may be unknown if the part fills the space above it now, or if
///   lines of sight show that nothing in the cell reaches up to the part.
void check_body(const Scene& scene, Findings& findings) noexcept;
/// - check_body_on_stairs: the same for class stair, with the lines of the nosings.
void check_body_on_stairs(const Scene& scene, Findings& findings) noexcept;
/// - check_bands: under the landing feet and within `drop_band` around them, no cell lies more than
///   `drop` below the stance, and no cell low enough for a foot has drop evidence. Within
///   kSmearTenthMm around the bands no drop shows either.
void check_bands(const Scene& scene, Findings& findings) noexcept;

}  // namespace surefoot::gate
