// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/regions.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace surefoot::gate {
namespace {

/// A cell with its place.
struct Place {
    GroundCell cell;
    std::int64_t ix = 0;
    std::int64_t iy = 0;
    Foot foot = Foot::none;
};

void count(const GroundCell& cell, Evidence& evidence) noexcept {
    ++evidence.cells;
    if (!cell.known()) return;
    ++evidence.known_cells;
    if (cell.knowledge == Knowledge::vouched) ++evidence.vouched_cells;
    evidence.max_drift_tenth_mm =
        std::max<std::int64_t>(evidence.max_drift_tenth_mm, cell.drift_tenth_mm);
    evidence.min_clearance_tenth_mm =
        std::min<std::int64_t>(evidence.min_clearance_tenth_mm, cell.clearance_tenth_mm);
}

void deny(Findings& findings,
          Reason reason,
          const Place& place,
          std::int64_t value,
          std::int64_t limit) noexcept {
    findings.deny(reason, finding_at(place.ix, place.iy, place.foot, value, limit));
}

/// Knowledge, sureness and drift: what every region asks of every cell. False when the cell says
/// nothing about the height of the ground.
bool check_knowledge(const Place& place, const GateLimits& limits, Findings& findings) noexcept {
    const GroundCell& cell = place.cell;
    count(cell, findings.evidence);
    if (cell.knowledge == Knowledge::outside) {
        deny(findings, Reason::outside_map, place, 0, 0);
        return false;
    }
    if (!cell.known()) {
        deny(findings, Reason::unknown_cells, place, 0, 0);
        return false;
    }
    if (cell.sigma_tenth_mm > limits.cell_sigma_tenth_mm)
        deny(findings,
             Reason::not_resolvable,
             place,
             cell.sigma_tenth_mm,
             limits.cell_sigma_tenth_mm);
    if (cell.drift_tenth_mm > limits.drift_tenth_mm)
        deny(findings, Reason::memory_uncertain, place, cell.drift_tenth_mm, limits.drift_tenth_mm);
    return true;
}

/// Wanted: `value`, a height or depth that the ground of the place is measured at, below `limit`
/// by `sigma_factor` sigma. What is measured beyond the limit is refused for `reason`; what is only
/// not sure to be below is not resolvable.
void check_below(const Place& place,
                 std::int64_t value,
                 std::int64_t limit,
                 Reason reason,
                 const GateLimits& limits,
                 Findings& findings) noexcept {
    if (value > limit) {
        deny(findings, reason, place, value, limit);
        return;
    }
    const double slack = static_cast<double>(limit - value);
    const std::int64_t sigma = place.cell.sigma_tenth_mm;
    if (!(limits.sigma_factor * static_cast<double>(sigma) <= slack))
        deny(findings,
             Reason::not_resolvable,
             place,
             sigma,
             static_cast<std::int64_t>(slack / limits.sigma_factor));
}

/// Wanted: nothing hangs lower over the stance than `height`.
void check_overhead(const Place& place,
                    std::int64_t rise,
                    std::int64_t height,
                    Reason reason,
                    Findings& findings) noexcept {
    if (place.cell.clearance_tenth_mm == grid::MapSnapshot::kNoCeiling) return;
    const std::int64_t ceiling = rise + place.cell.clearance_tenth_mm;
    if (!(ceiling < height)) return;
    Finding finding = finding_at(place.ix, place.iy, place.foot, ceiling, height);
    finding.severity = height - ceiling;
    finding.overhead = true;
    findings.deny(reason, finding);
}

/// Asks one cell of a region; `test(place, rise)` sees it with its height over the stance if it is
/// known, `always(place)` if it is inside the map. False when it is not: one cell beyond the map
/// ends a region, the rest of it out there tells nothing new.
template <typename Test, typename Always>
bool check_cell(const Scene& scene,
                std::int64_t ix,
                std::int64_t iy,
                Foot foot,
                Findings& findings,
                Test&& test,
                Always&& always) noexcept {
    const Place place{scene.ground.cell(ix, iy), ix, iy, foot};
    const bool inside = place.cell.knowledge != Knowledge::outside;
    if (inside) always(place);
    if (check_knowledge(place, scene.machine.limits, findings))
        test(place, place.cell.height_tenth_mm - scene.stance_tenth_mm);
    return inside;
}

/// Asks every cell of a region.
template <typename Test, typename Always>
void check_region(const Scene& scene,
                  const grid::FixedConvex& region,
                  Foot foot,
                  Findings& findings,
                  Test&& test,
                  Always&& always) noexcept {
    grid::for_each_overlapped_cell(
        region, scene.ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
            return check_cell(scene, ix, iy, foot, findings, test, always);
        });
}

/// Nothing stands as high as a part of the body begins, nor hangs lower than it ends.
void check_part(const BodyPart& part,
                const Place& place,
                std::int64_t rise,
                Findings& findings) noexcept {
    if (rise > part.low_tenth_mm)
        deny(findings, Reason::body_clearance, place, rise, part.low_tenth_mm);
    check_overhead(place, rise, part.high_tenth_mm, Reason::body_clearance, findings);
}

constexpr auto kNothing = [](const Place&) noexcept {};

}  // namespace

Finding finding_at(std::int64_t ix,
                   std::int64_t iy,
                   Foot foot,
                   std::int64_t value_tenth_mm,
                   std::int64_t limit_tenth_mm) noexcept {
    return {ix, iy, value_tenth_mm, limit_tenth_mm, value_tenth_mm, foot};
}

std::optional<std::int64_t> stance_height(const Ground& ground,
                                          const Query& query,
                                          const Sweep& sweep) noexcept {
    if (query.stance_source == StanceHeight::given) return query.stance_height_tenth_mm;
    std::int64_t sum = 0;
    std::int64_t known = 0;
    for (const FootSweep& foot : sweep.feet) {
        grid::for_each_overlapped_cell(
            foot.stance, ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
                const GroundCell cell = ground.cell(ix, iy);
                if (cell.known()) {
                    sum += cell.height_tenth_mm;
                    ++known;
                }
                return true;
            });
    }
    if (known == 0) return std::nullopt;
    return grid::floor_div(2 * sum + known, 2 * known);  // to nearest
}

ReachableSurfaces surfaces_of_stance(const Scene& scene) noexcept {
    ReachableSurfaces reachable;
    const std::int64_t step = scene.machine.limits.swing_clearance_tenth_mm;
    for (const FootSweep& foot : scene.sweep.feet) {
        grid::for_each_overlapped_cell(
            foot.stance, scene.ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
                const GroundCell cell = scene.ground.cell(ix, iy);
                const std::int64_t rise = cell.height_tenth_mm - scene.stance_tenth_mm;
                if (cell.knowledge == Knowledge::measured && rise >= -step && rise <= step)
                    reachable.add(cell.component);
                return true;
            });
    }
    reachable.add_beside_vouched(scene.ground, scene.machine.limits.swing_clearance_tenth_mm);
    return reachable;
}

void check_stance(const Scene& scene, Findings& findings) noexcept {
    const GateLimits& limits = scene.machine.limits;
    for (const FootSweep& foot : scene.sweep.feet) {
        const auto test = [&](const Place& place, std::int64_t rise) {
            check_below(place, -rise, limits.drop_tenth_mm, Reason::drop_off, limits, findings);
        };
        check_region(scene, foot.stance, foot.foot, findings, test, kNothing);
    }
}

void check_corridors(const Scene& scene, Findings& findings) noexcept {
    const GateLimits& limits = scene.machine.limits;
    const std::int64_t lifted =
        std::int64_t{scene.machine.body.lower_edge_tenth_mm()} + limits.swing_clearance_tenth_mm;
    for (const FootSweep& foot : scene.sweep.feet) {
        const auto test = [&](const Place& place, std::int64_t rise) {
            check_below(place,
                        rise,
                        limits.swing_clearance_tenth_mm,
                        Reason::corridor_blocked,
                        limits,
                        findings);
            check_overhead(place, rise, lifted, Reason::corridor_blocked, findings);
        };
        check_region(scene, foot.corridor, foot.foot, findings, test, kNothing);
    }
}

void check_body(const Scene& scene, Findings& findings) noexcept {
    const std::span<const BodyPart> parts = scene.machine.body.all();
    std::array<grid::RowRuns, Body::kMaxParts> areas;
    grid::FixedRun rows{INT64_MAX, INT64_MIN};
    for (std::size_t i = 0; i < parts.size(); ++i) {
        areas[i] = {scene.sweep.body[i], scene.ground.grid()};
        rows = {std::min(rows.first, areas[i].rows().first),
                std::max(rows.last, areas[i].rows().last)};
    }
    // The parts lie over each other: every cell is asked once, and then for each part above it.
    for (std::int64_t iy = rows.first; iy <= rows.last; ++iy) {
        std::array<grid::FixedRun, Body::kMaxParts> runs;
        grid::FixedRun all{INT64_MAX, INT64_MIN};
        for (std::size_t i = 0; i < parts.size(); ++i) {
            runs[i] = areas[i].run(iy);
            if (runs[i].last < runs[i].first) continue;
            all = {std::min(all.first, runs[i].first), std::max(all.last, runs[i].last)};
        }
        const auto over = [&](std::int64_t ix) {
            std::uint32_t mask = 0;
            for (std::size_t i = 0; i < parts.size(); ++i)
                mask |= (runs[i].contains(ix) ? 1U : 0U) << i;
            return mask;
        };
        for (std::int64_t ix = all.first; ix <= all.last; ++ix) {
            const std::uint32_t mask = over(ix);
            if (mask == 0) continue;
            const auto test = [&](const Place& place, std::int64_t rise) {
                for (std::size_t i = 0; i < parts.size(); ++i) {
                    if ((mask >> i & 1U) != 0) check_part(parts[i], place, rise, findings);
                }
            };
            if (!check_cell(scene, ix, iy, Foot::none, findings, test, kNothing)) return;
        }
    }
}

void check_bands(const Scene& scene, Findings& findings) noexcept {
    const GateLimits& limits = scene.machine.limits;
    for (const FootSweep& foot : scene.sweep.feet) {
        const auto test = [&](const Place& place, std::int64_t rise) {
            check_below(place, -rise, limits.drop_tenth_mm, Reason::drop_off, limits, findings);
        };
        // A drop below a table top beside the foot is no drop for a foot on the floor: evidence on
        // a cell that was measured higher than a foot may stand belongs to somebody up there.
        const auto evidence = [&](const Place& place) {
            const bool above =
                place.cell.known() && place.cell.height_tenth_mm - scene.stance_tenth_mm >
                                          limits.swing_clearance_tenth_mm;
            if (place.cell.drop_evidence >= limits.drop_evidence && !above)
                deny(findings, Reason::drop_off, place, 0, limits.drop_tenth_mm);
        };
        check_region(scene, foot.band, foot.foot, findings, test, evidence);
    }
}

}  // namespace surefoot::gate
