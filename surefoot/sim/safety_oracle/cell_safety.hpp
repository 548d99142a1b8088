// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/views.hpp"
#include "surefoot/sim/safety_oracle/safety_oracle.hpp"
#include "surefoot/sim/scenes/truth.hpp"

namespace surefoot::sim {

/// Safety of a foot that stands centred on a cell. Unsafe unless proved safe.
struct CellSafety {
    bool safe = false;
    Danger danger = Danger::no_ground;  ///< most important danger of an unsafe cell

    friend bool operator==(const CellSafety&, const CellSafety&) = default;
};

struct CellQuestion {
    double yaw_rad = 0.0;  ///< heading of the foot in the world
    /// A point on the ground where the machine walks; separates floors from table tops and storeys.
    Eigen::Vector3d start_m = Eigen::Vector3d::Zero();
    /// Neighbouring cells whose heights differ by more than this are not joined. The value lies
    /// above the highest riser of NZ D1/AS1 (220 mm, service stairs) and far below a table.
    double joined_m = 0.25;
};

/// Computes the ground truth of a map from the scene geometry alone, for the machine's left foot.
/// If a cell has several surfaces, the highest one that is joined to the start counts. Dangers:
/// disconnected (no surface of the cell is joined), no_ground (a void under the foot), drop_off and
/// step_up (ground under the foot differs from the cell by more than the drop limit), tilt,
/// roughness, edge_too_near (as for a landing foot), body_hits and overhang_too_low (no room for
/// the user above the foot; the width of the body is not checked).
[[nodiscard]] Image<CellSafety> cell_safety(const Scene& scene,
                                            const Machine& machine,
                                            const Lattice& lattice,
                                            const CellQuestion& question,
                                            Executor& executor);

}  // namespace surefoot::sim
