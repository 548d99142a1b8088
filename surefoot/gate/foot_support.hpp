// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/gate/regions.hpp"

namespace surefoot::gate {

/// Ground under one landing foot, all of it flat:
/// 1. every cell known, and every measured one on a surface that the machine stands on;
/// 2. cells of one level: their spread is within swing_clearance + drop, else ROUGHNESS;
/// 3. least-squares plane through the cells: tilt within the limit (z of its normal against a
///    cosine), height at the middle of the foot within the step limits of the movement's class;
/// 4. the foot is cut into patches of at least `patch_side` (50 mm). For each the variance of the
/// mean
///    is (mean of the cells' variances) / min(cells, `patch_independent_cells`): errors of
///    neighbouring cells are partly the same error, so averaging is credited for a fixed small
///    number of cells only, whatever the cell size. Wanted: sigma <= `patch_sigma`, and |residual
///    to the plane| + sigma_factor * sigma <= `patch_residual`.
/// 5. every cell within those step limits: a toe on the beginning of a ramp is a step, though the
///    middle of the foot is not.
/// No mean over the foot decides: each patch does, the worst one is reported.
void check_landing(const Scene& scene,
                   const FootSweep& foot,
                   const GroundBox& box,
                   const ReachableSurfaces& reachable,
                   Findings& findings) noexcept;

}  // namespace surefoot::gate
