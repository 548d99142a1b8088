// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/query_zone.hpp"

#include <algorithm>

#include "surefoot/gate/footprints.hpp"
#include "surefoot/gate/ground.hpp"

namespace surefoot::gate_process {
namespace {

using grid::MapSnapshot;

/// Limits of 100 km and 2 m, as in the gate. Within these limits no product overflows.
constexpr std::int64_t kFarthestTenthMm = 1'000'000'000;
constexpr std::int64_t kWidestAttestedTenthMm = 20'000;

constexpr bool within(std::int64_t value, std::int64_t bound) noexcept {
    return value >= -bound && value <= bound;
}

bool is_unit(double value) noexcept {
    return value >= -1.001 && value <= 1.001;  // false for NaN
}

bool has_cells(const MapSnapshot& map) noexcept {
    return map.nx >= 1 && map.nx <= MapSnapshot::kMaxSide && map.ny >= 1 &&
           map.ny <= MapSnapshot::kMaxSide && map.resolution_tenth_mm >= 1 &&
           within(map.origin_x_tenth_mm, kFarthestTenthMm) &&
           within(map.origin_y_tenth_mm, kFarthestTenthMm);
}

/// True for every query that passes the gate's own tests before the gate reads the ground. May be
/// true for other queries.
bool can_look(const Machine& machine, const gate::Query& query, const MapSnapshot& map) noexcept {
    const gate::AttestedArea& area = query.attested;
    const bool attested = !area.active || (within(area.center_x_tenth_mm, kFarthestTenthMm) &&
                                           within(area.center_y_tenth_mm, kFarthestTenthMm) &&
                                           area.radius_tenth_mm > 0 &&
                                           area.radius_tenth_mm <= kWidestAttestedTenthMm);
    return has_cells(map) && machine.problem() == nullptr &&
           query.command < Machine::kMovementCodes && machine.movements[query.command].configured &&
           within(query.x_tenth_mm, kFarthestTenthMm) &&
           within(query.y_tenth_mm, kFarthestTenthMm) && is_unit(query.cos_yaw) &&
           is_unit(query.sin_yaw) && attested;
}

/// The first cell and the number of cells of [low, high] on an axis of `n` cells.
struct Range {
    std::int32_t first = 0;
    std::int32_t count = 0;
};
Range cells_between(
    std::int64_t low, std::int64_t high, std::int64_t origin, std::int64_t side, std::int64_t n) {
    const std::int64_t first = std::clamp<std::int64_t>(grid::floor_div(low - origin, side), 0, n);
    const std::int64_t end =
        std::clamp<std::int64_t>(grid::floor_div(high - origin, side) + 1, first, n);
    return {static_cast<std::int32_t>(first), static_cast<std::int32_t>(end - first)};
}

}  // namespace

bool is_inside(const CellBox& box, const MapSnapshot& map) noexcept {
    return has_cells(map) && box.x >= 0 && box.y >= 0 && box.nx >= 0 && box.ny >= 0 &&
           box.x <= map.nx && box.nx <= map.nx - box.x && box.y <= map.ny &&
           box.ny <= map.ny - box.y;
}

CellBox query_zone(const Machine& machine,
                   const gate::Query& query,
                   const MapSnapshot& map,
                   std::int64_t drift_tenth_mm) noexcept {
    if (!can_look(machine, query, map)) return {};
    const gate::FixedPose start =
        gate::fixed_pose(query.x_tenth_mm, query.y_tenth_mm, query.cos_yaw, query.sin_yaw);
    // The gate refuses cells with more drift than the limit, before these cells widen a region.
    const std::int64_t drift =
        std::clamp<std::int64_t>(drift_tenth_mm, 0, machine.limits.drift_tenth_mm);
    const gate::Sweep sweep = gate::sweep_of(machine,
                                             start,
                                             machine.movements[query.command],
                                             gate::drift_margin(machine.limits, drift));
    const gate::Extent bounds = gate::Ground(map, query, machine.limits).zone_of(sweep);
    const std::int64_t side = map.resolution_tenth_mm;
    const Range x = cells_between(bounds.low.x, bounds.high.x, map.origin_x_tenth_mm, side, map.nx);
    const Range y = cells_between(bounds.low.y, bounds.high.y, map.origin_y_tenth_mm, side, map.ny);
    if (x.count == 0 || y.count == 0) return {};
    return {x.first, y.first, x.count, y.count};
}

}  // namespace surefoot::gate_process
