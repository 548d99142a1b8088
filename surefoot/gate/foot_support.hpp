// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/gate/regions.hpp"

namespace surefoot::gate {

/// Checks the ground under one landing foot on flat ground:
/// 1. Every cell is known, and every measured cell belongs to a reachable surface.
/// 2. The cells, except the pebble of rule 5, lie on one level: highest minus lowest cell is at
///    most swing_clearance + drop. If not, the reason is ROUGHNESS.
/// 3. A least-squares plane through the cells keeps the tilt limit (z of its normal against a
///    cosine). Its height at the middle of the foot keeps the step limits of the movement class.
/// 4. The foot is cut into patches of at least `patch_side` (50 mm). For cells of equal weight,
///    the variance of a patch mean is (mean of the cell variances) / min(cells,
///    `patch_independent_cells`), because errors of neighbouring cells are correlated. Cells with
///    sigma above `patch_sigma` have less weight. Each patch needs sigma <= `patch_sigma` and
///    |residual to the plane| + sigma_factor * sigma <= `patch_residual`.
/// 5. Every cell keeps the step limits of rule 3; one cell among good cells (a pebble) may break
///    them. Example: toes on a ramp step up, even if the middle of the foot does not.
/// No mean over the foot judges its evenness: each patch is tested, and the worst is reported.
void check_landing(const Scene& scene,
                   const FootSweep& foot,
                   const GroundBox& box,
                   const ReachableSurfaces& reachable,
                   Findings& findings) noexcept;

}  // namespace surefoot::gate
