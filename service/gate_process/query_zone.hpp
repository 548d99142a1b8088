// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "surefoot/gate/gate.hpp"

namespace surefoot::gate_process {

/// A rectangle of snapshot cells: first cell and size in x and y [cells].
struct CellBox {
    std::int32_t x = 0;
    std::int32_t y = 0;
    std::int32_t nx = 0;
    std::int32_t ny = 0;

    [[nodiscard]] std::size_t cells() const noexcept {
        return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny);
    }
    friend bool operator==(const CellBox&, const CellBox&) = default;
};

/// True if the rectangle lies inside the map and the map's layers have these cells.
[[nodiscard]] bool is_inside(const CellBox& box, const grid::MapSnapshot& map) noexcept;

/// Returns the rectangle of all cells that decide() may read for a query, plus a ring of cells. It
/// covers both feet at start and target with corridors and drop bands, the path of the body, and
/// the attested area. `drift_tenth_mm`: the largest drift of the verdict (Evidence); it widens the
/// regions. Accepts any arguments. Empty if decide() does not read the ground (invalid pose,
/// command, machine or map size), or if the zone is outside the map. Pure; allocates nothing; takes
/// about a microsecond.
[[nodiscard]] CellBox query_zone(const Machine& machine,
                                 const gate::Query& query,
                                 const grid::MapSnapshot& map,
                                 std::int64_t drift_tenth_mm) noexcept;

}  // namespace surefoot::gate_process
