// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/truth.hpp"
#include "surefoot/core/machine.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::app {

/// Verdicts of the gate beside what is true. Questions whose truth changes within the margin of a
/// good map (see sim::SafetyMargin) are counted apart: there the gate may be more careful.
struct VerdictCounts {
    int safe = 0;               ///< clear-cut questions whose true answer is "safe" ...
    int safe_ok = 0;            ///< ... and the gate said OK
    int unsafe = 0;             ///< clear-cut and truly dangerous ...
    int unsafe_ok = 0;          ///< ... and the gate said OK: a missed hazard
    int borderline = 0;         ///< not clear-cut
    int borderline_ok = 0;      ///< of these OK
    int borderline_missed = 0;  ///< OK although the exact truth says dangerous

    /// Counts one question.
    void add(bool truly_safe, bool clear_cut, bool allowed);
};

/// Asks the gate for every movement of the machine at where it stands, and at places around it
/// that it could have walked to: 0.2 m apart, within `reach_m`, with the yaw of the present pose.
/// Ground under the standing feet is vouched for where nothing was measured, as offline.
[[nodiscard]] VerdictCounts compare_verdicts(const sim::SceneTruth& truth,
                                             const Pose& T_world_body_true,
                                             const Machine& machine,
                                             const grid::MapSnapshot& map,
                                             double reach_m);

}  // namespace surefoot::app
