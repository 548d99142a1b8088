// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/views.hpp"
#include "surefoot/sim/safety_oracle/safety_oracle.hpp"
#include "surefoot/sim/scenes/truth.hpp"

namespace surefoot::sim {

/// Could a foot stand with its middle on the middle of a cell? Not safe unless shown.
struct CellSafety {
    bool safe = false;
    Danger danger = Danger::no_ground;  ///< of an unsafe cell, the one that matters most

    friend bool operator==(const CellSafety&, const CellSafety&) = default;
};

struct CellQuestion {
    double yaw_rad = 0.0;  ///< of the foot in the world
    /// Somewhere on the ground where the machine walks; tells floors from table tops and storeys.
    Eigen::Vector3d start_m = Eigen::Vector3d::Zero();
    /// What differs by more between neighbouring cells is not joined: above the highest riser of
    /// NZ D1/AS1 (220 mm, service stairs), far below a table.
    double joined_m = 0.25;
};

/// The truth for a map, from the scene's geometry alone. The foot is the machine's left one. Of
/// several surfaces in a cell the highest counts that is joined to the start. Dangers:
/// disconnected (nothing in the cell is joined), no_ground (a void under the foot), drop_off and
/// step_up (ground under the foot lower or higher than the cell by more than the drop limit), tilt,
/// roughness, edge_too_near (as for a landing foot), body_hits and overhang_too_low (no room for
/// the user over the foot; the width of the body is not asked for).
[[nodiscard]] Image<CellSafety> cell_safety(const Scene& scene,
                                            const Machine& machine,
                                            const Lattice& lattice,
                                            const CellQuestion& question,
                                            Executor& executor);

}  // namespace surefoot::sim
