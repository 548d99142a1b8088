// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/ground.hpp"

#include <algorithm>

#include "surefoot/gate/tilt.hpp"

namespace surefoot::gate {
Ground::Ground(const grid::MapSnapshot& map, const Query& query, const GateLimits& limits) noexcept
    : map_(map),
      grid_{map.origin_x_tenth_mm, map.origin_y_tenth_mm, map.resolution_tenth_mm},
      attested_(query.attested.active ? query.attested : AttestedArea{}),
      vertical_bound_tan_(gate::vertical_bound_tan(map, limits)),
      drop_tenth_mm_(limits.drop_tenth_mm) {
    // The attestation is invalid as soon as base_link is outside the area.
    const std::int64_t dx = query.x_tenth_mm - attested_.center_x_tenth_mm;
    const std::int64_t dy = query.y_tenth_mm - attested_.center_y_tenth_mm;
    const std::int64_t radius = attested_.radius_tenth_mm;
    attestation_ = attested_.active && grid::magnitude(dx) <= radius &&
                   grid::magnitude(dy) <= radius && dx * dx + dy * dy <= radius * radius;
}

std::span<const grid::SnapshotEdge> Ground::edges() const noexcept {
    const auto count = std::clamp(map_.edge_count, 0, grid::MapSnapshot::kMaxEdges);
    return {map_.edges.data(), static_cast<std::size_t>(count)};
}

void Ground::take_word(std::size_t at,
                       std::int64_t ix,
                       std::int64_t iy,
                       GroundCell& cell) const noexcept {
    const bool measured = cell.knowledge == Knowledge::measured;
    if ((measured && !is_unsure_but_agrees(cell)) || !is_attested(ix, iy)) return;
    if (!measured && is_proven_lower(at)) {
        cell.drop_evidence = UINT8_MAX;
        return;
    }
    cell.knowledge = Knowledge::attested;
    cell.height_tenth_mm = attested_.height_tenth_mm;
    cell.sigma_tenth_mm = 0;
}

bool Ground::is_below(std::int64_t ix, std::int64_t iy, std::int64_t z_tenth_mm) const noexcept {
    if (ix < 0 || iy < 0 || ix >= map_.nx || iy >= map_.ny) return false;
    const std::int64_t bound = map_.height_tenth_mm[static_cast<std::size_t>(iy * map_.nx + ix)];
    return bound != grid::MapSnapshot::kUnknownHeight && bound <= z_tenth_mm;
}

bool Ground::is_unsure_but_agrees(const GroundCell& cell) const noexcept {
    constexpr std::int32_t kUnsureTenthMm = 79;
    constexpr std::int64_t kAgreesTenthMm = 150;
    const std::int64_t off = cell.height_tenth_mm - attested_.height_tenth_mm;
    return cell.sigma_tenth_mm > kUnsureTenthMm && off >= -kAgreesTenthMm && off <= kAgreesTenthMm;
}

bool Ground::is_proven_lower(std::size_t at) const noexcept {
    const std::int64_t bound = map_.height_tenth_mm[at];
    return bound != grid::MapSnapshot::kUnknownHeight &&
           bound < std::int64_t{attested_.height_tenth_mm} - drop_tenth_mm_;
}

bool Ground::is_attested(std::int64_t ix, std::int64_t iy) const noexcept {
    const std::int64_t x = grid_.origin_x + ix * grid_.side - attested_.center_x_tenth_mm;
    const std::int64_t y = grid_.origin_y + iy * grid_.side - attested_.center_y_tenth_mm;
    const std::int64_t far_x = std::max(grid::magnitude(x), grid::magnitude(x + grid_.side));
    const std::int64_t far_y = std::max(grid::magnitude(y), grid::magnitude(y + grid_.side));
    const std::int64_t radius = attested_.radius_tenth_mm;
    return far_x * far_x + far_y * far_y <= radius * radius;
}

Extent Ground::zone_of(const Sweep& sweep) const noexcept {
    Extent zone = extent_of(sweep);
    zone = {{zone.low.x - grid_.side, zone.low.y - grid_.side},
            {zone.high.x + grid_.side, zone.high.y + grid_.side}};
    if (attestation_) {
        const std::int64_t reach = std::int64_t{attested_.radius_tenth_mm} + grid_.side;
        const std::int64_t x = attested_.center_x_tenth_mm;
        const std::int64_t y = attested_.center_y_tenth_mm;
        zone.include({x - reach, y - reach});
        zone.include({x + reach, y + reach});
    }
    return zone;
}

bool Ground::is_intact(const Extent& zone) const noexcept {
    return grid::are_rows_intact(map_,
                                 grid::floor_div(zone.low.y - grid_.origin_y, grid_.side),
                                 grid::floor_div(zone.high.y - grid_.origin_y, grid_.side));
}

grid::FixedPoint Ground::doubled_center(std::int64_t ix,
                                        std::int64_t iy,
                                        grid::FixedPoint origin) const noexcept {
    return {2 * (grid_.origin_x - origin.x) + (2 * ix + 1) * grid_.side,
            2 * (grid_.origin_y - origin.y) + (2 * iy + 1) * grid_.side};
}

void ReachableSurfaces::add(std::uint16_t component) noexcept {
    if (component == grid::MapSnapshot::kNoComponent) return;
    bits_[component / 64U] |= std::uint64_t{1} << (component % 64U);
}

bool ReachableSurfaces::contains(std::uint16_t component) const noexcept {
    return component != grid::MapSnapshot::kNoComponent &&
           (bits_[component / 64U] >> (component % 64U) & 1U) != 0;
}

void ReachableSurfaces::add_beside_attested(const Ground& ground,
                                            std::int32_t step_tenth_mm) noexcept {
    if (!ground.is_attesting()) return;
    const AttestedArea& area = ground.attested();
    const grid::FixedGrid& grid = ground.grid();
    const std::int64_t reach = area.radius_tenth_mm + grid.side;
    const auto index = [&grid](std::int64_t p, std::int64_t origin) {
        return grid::floor_div(p - origin, grid.side);
    };
    const std::int64_t last_y = index(area.center_y_tenth_mm + reach, grid.origin_y);
    const std::int64_t last_x = index(area.center_x_tenth_mm + reach, grid.origin_x);
    for (auto iy = index(area.center_y_tenth_mm - reach, grid.origin_y); iy <= last_y; ++iy) {
        for (auto ix = index(area.center_x_tenth_mm - reach, grid.origin_x); ix <= last_x; ++ix) {
            const GroundCell cell = ground.cell(ix, iy);
            const grid::FixedPoint from_center =
                ground.doubled_center(ix, iy, {area.center_x_tenth_mm, area.center_y_tenth_mm});
            const std::int64_t distance_sq =
                from_center.x * from_center.x + from_center.y * from_center.y;
            if (cell.known() && distance_sq <= 4 * reach * reach &&
                grid::magnitude(cell.height_tenth_mm - area.height_tenth_mm) <= step_tenth_mm)
                add(cell.component);
        }
    }
}

}  // namespace surefoot::gate
