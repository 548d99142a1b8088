// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "surefoot/gate/gate.hpp"

namespace surefoot::gate_process {

/// A rectangle of cells of a snapshot: the first one and how many. It lies inside the map.
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

/// Whether a rectangle lies inside a map whose layers it can index.
[[nodiscard]] bool is_inside(const CellBox& box, const grid::MapSnapshot& map) noexcept;

/// Every cell that decide() may read for a query, and some more: the rectangle around both feet at
/// start and target with their corridors and drop bands, the body's way, and the vouched area, with
/// a ring of cells beside them. `drift_tenth_mm`: the most that a verdict met (Evidence), the wider
/// are the regions. Any arguments may come: empty where decide() does not look at the
/// ground (a pose, a command, a machine or a size of the map that cannot be), or where the zone
/// lies beyond the map. Pure, allocates nothing; about a microsecond.
[[nodiscard]] CellBox query_zone(const Machine& machine,
                                 const gate::Query& query,
                                 const grid::MapSnapshot& map,
                                 std::int64_t drift_tenth_mm) noexcept;

}  // namespace surefoot::gate_process
