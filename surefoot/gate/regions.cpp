// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/regions.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "surefoot/gate/nosing_lines.hpp"

namespace surefoot::gate {
namespace {

// Functions that test each of the thousands of cells of a verdict are always_inline. They have
// several callers, so the compiler would not inline them. Inlining reduces the time per verdict
// from 0.055 ms to 0.043 ms.

/// A cell and its position.
struct Place {
    GroundCell cell;
    std::int64_t ix = 0;
    std::int64_t iy = 0;
    Foot foot = Foot::none;
};

[[gnu::always_inline]] inline void count(const GroundCell& cell, Evidence& evidence) noexcept {
    ++evidence.cells;
    if (!cell.known()) return;
    ++evidence.known_cells;
    if (cell.knowledge == Knowledge::attested) ++evidence.attested_cells;
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

/// True if the sigma is at most `cell_sigma`. A single cell may have twice that sigma if its eight
/// neighbours are known and keep the limit: the cell has just rejected measurements, and its
/// neighbours have not.
bool is_sure(const Scene& scene, const Place& place) noexcept {
    constexpr std::int64_t kAloneFactor = 2;
    const std::int64_t limit = scene.machine.limits.cell_sigma_tenth_mm;
    if (place.cell.sigma_tenth_mm <= limit) return true;
    return place.cell.sigma_tenth_mm <= kAloneFactor * limit &&
           scene.ground.all_around(
               place.ix, place.iy, [limit](const GroundCell& beside, auto, auto) {
                   return beside.sigma_tenth_mm <= limit;
               });
}

/// Reports why a cell fails. This is the slow path of check_knowledge().
bool check_doubtful(const Scene& scene, const Place& place, Findings& findings) noexcept {
    const GateLimits& limits = scene.machine.limits;
    const GroundCell& cell = place.cell;
    if (!cell.known()) {
        deny(findings, reason_of_unknown(cell.knowledge), place, 0, 0);
        return false;
    }
    if (!is_sure(scene, place))
        deny(findings,
             Reason::not_resolvable,
             place,
             cell.sigma_tenth_mm,
             limits.cell_sigma_tenth_mm);
    if (cell.drift_tenth_mm > limits.drift_tenth_mm)
        deny(findings, Reason::memory_uncertain, place, cell.drift_tenth_mm, limits.drift_tenth_mm);
    return true;
}

/// Tests that a cell is known, certain and not drifted; every cell of every region must pass.
/// Returns false if the cell has no usable height. Nearly every cell passes after a few
/// comparisons.
[[gnu::always_inline]] inline bool check_knowledge(const Scene& scene,
                                                   const Place& place,
                                                   Findings& findings) noexcept {
    const GateLimits& limits = scene.machine.limits;
    const GroundCell& cell = place.cell;
    count(cell, findings.evidence);
    if (cell.known() && cell.sigma_tenth_mm <= limits.cell_sigma_tenth_mm &&
        cell.drift_tenth_mm <= limits.drift_tenth_mm)
        return true;
    return check_doubtful(scene, place, findings);
}

/// Returns the height of a cell above the plane of the stance.
std::int64_t rise_of(const Scene& scene, const Place& place) noexcept {
    return place.cell.height_tenth_mm - scene.stance.plane.at(place.ix, place.iy);
}

/// The side of the stance height on which a limit lies.
enum class Side : std::int8_t { up = 1, down = -1 };

/// True if the ground of a cell keeps `limit` on this side of the stance by `factor` sigma.
bool is_below(
    const Scene& scene, const Place& place, Side side, std::int64_t limit, double factor) noexcept {
    const std::int64_t slack = limit - static_cast<std::int64_t>(side) * rise_of(scene, place);
    return factor * static_cast<double>(place.cell.sigma_tenth_mm) <= static_cast<double>(slack);
}

/// Reports why a cell fails. This is the slow path of check_below().
void check_unsure(const Scene& scene,
                  const Place& place,
                  Side side,
                  std::int64_t limit,
                  Reason reason,
                  Findings& findings) noexcept {
    const std::int64_t value = static_cast<std::int64_t>(side) * rise_of(scene, place);
    if (value > limit) {
        deny(findings, reason, place, value, limit);
        return;
    }
    const double factor = scene.machine.limits.sigma_factor;
    if (is_below(scene, place, side, limit, 1.0) &&
        scene.ground.all_around(
            place.ix, place.iy, [&](const GroundCell& beside, std::int64_t ix, std::int64_t iy) {
                return is_below(scene, {beside, ix, iy}, side, limit, factor);
            }))
        return;
    deny(findings,
         Reason::not_resolvable,
         place,
         place.cell.sigma_tenth_mm,
         // in range: Machine::problem() keeps sigma_factor in 3-10
         static_cast<std::int64_t>(static_cast<double>(limit - value) / factor));
}

/// Requires that the ground of a cell keeps `limit` on this side of the stance by `sigma_factor`
/// sigma. A single cell needs only one sigma if its eight neighbours pass: the cell has just
/// rejected measurements, and real obstacles or holes are seldom smaller than a cell. A height
/// beyond the limit is refused with `reason`; a height that is only uncertain is refused with
/// NOT_RESOLVABLE.
[[gnu::always_inline]] inline void check_below(const Scene& scene,
                                               const Place& place,
                                               Side side,
                                               std::int64_t limit,
                                               Reason reason,
                                               Findings& findings) noexcept {
    if (!is_below(scene, place, side, limit, scene.machine.limits.sigma_factor))
        check_unsure(scene, place, side, limit, reason, findings);
}

/// Requires that nothing above the cell hangs lower than `height` above the stance.
[[gnu::always_inline]] inline void check_overhead(const Scene& scene,
                                                  const Place& place,
                                                  std::int64_t height,
                                                  Reason reason,
                                                  Findings& findings) noexcept {
    if (place.cell.clearance_tenth_mm == grid::MapSnapshot::kNoCeiling) return;
    const std::int64_t ceiling = rise_of(scene, place) + place.cell.clearance_tenth_mm;
    if (!(ceiling < height)) return;
    Finding finding = finding_at(place.ix, place.iy, place.foot, ceiling, height);
    finding.severity = height - ceiling;
    finding.overhead = true;
    findings.deny(reason, finding);
}

constexpr auto kNothing = [](const Place&) noexcept {};
constexpr auto kAsMapped = [](const Place&) noexcept {};

/// Tests every cell of a region: `always(place)` for a cell inside the map, `test(place)` for a
/// known cell. `sharpen(place)` may change a cell before. Ends at the first cell outside the map,
/// because further ones add nothing.
template <typename Test, typename Always, typename Sharpen = const decltype(kAsMapped)&>
void check_region(const Scene& scene,
                  const grid::FixedConvex& region,
                  Foot foot,
                  Findings& findings,
                  Test&& test,
                  Always&& always,
                  Sharpen&& sharpen = kAsMapped) noexcept {
    grid::for_each_overlapped_cell(
        region, scene.ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
            Place place{scene.ground.cell(ix, iy), ix, iy, foot};
            sharpen(place);
            const bool inside = place.cell.knowledge != Knowledge::outside;
            if (inside) always(place);
            if (check_knowledge(scene, place, findings)) test(place);
            return inside;
        });
}

/// The space of the body over some neighbouring cells of a row: from the lowest to the highest part
/// of the body there, including free space between the parts.
struct BodyOver {
    std::int64_t low_tenth_mm = INT64_MAX;
    std::int64_t high_tenth_mm = INT64_MIN;
    std::int64_t last = INT64_MAX;  ///< last cell of the row with the same parts above it

    [[nodiscard]] bool any() const noexcept { return high_tenth_mm > low_tenth_mm; }
};

BodyOver body_over(std::span<const BodyPart> parts,
                   std::span<const grid::FixedRun> runs,
                   std::int64_t ix) noexcept {
    BodyOver over;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (runs[i].last < runs[i].first) continue;
        if (ix < runs[i].first) over.last = std::min(over.last, runs[i].first - 1);
        if (!runs[i].contains(ix)) continue;
        over.last = std::min(over.last, runs[i].last);
        over.low_tenth_mm = std::min<std::int64_t>(over.low_tenth_mm, parts[i].low_tenth_mm);
        over.high_tenth_mm = std::max<std::int64_t>(over.high_tenth_mm, parts[i].high_tenth_mm);
    }
    return over;
}

/// Tells whether the body may move over unknown cells. A row is computed when its first unknown
/// cell is met.
class UnknownBelowBody {
  public:
    explicit UnknownBelowBody(const Scene& scene) noexcept : scene_(scene) {}

    /// True if each part of the body that enters the space above this cell is higher than anything
    /// in the cell can be (Ground::is_below). The space that a part fills now needs no proof.
    [[nodiscard]] bool is_free(std::int64_t ix, std::int64_t iy) noexcept {
        const std::int64_t ground = scene_.stance.plane.at(ix, iy);
        const grid::FixedGrid& grid = scene_.ground.grid();
        if (iy != iy_) find_row(iy);
        const std::span<const BodyPart> parts = scene_.machine.body.all();
        for (std::size_t i = 0; i < parts.size(); ++i) {
            if (!way_[i].contains(ix)) continue;
            if (here_[i].contains(ix) && scene_.sweep.body[i].stays_in(ix, iy, grid)) continue;
            if (!scene_.ground.is_below(ix, iy, ground + parts[i].low_tenth_mm)) return false;
        }
        return true;
    }

  private:
    void find_row(std::int64_t iy) noexcept {
        iy_ = iy;
        for (std::size_t i = 0; i < scene_.machine.body.all().size(); ++i) {
            const PartSweep& part = scene_.sweep.body[i];
            way_[i] = grid::RowRuns(part.way, scene_.ground.grid()).run(iy);
            here_[i] = grid::RowRuns(part.here, scene_.ground.grid()).run(iy);
        }
    }

    const Scene& scene_;
    std::int64_t iy_ = INT64_MIN;
    std::array<grid::FixedRun, Body::kMaxParts> way_;
    std::array<grid::FixedRun, Body::kMaxParts> here_;
};

/// Tests that a known cell in the path of the body leaves room for the parts above it. Here the
/// sigma of the cell counts only against the lower edge of the body.
void check_body_cell(const Scene& scene,
                     const Place& place,
                     const BodyOver& over,
                     Findings& findings) noexcept {
    const std::int64_t drift_limit = scene.machine.limits.drift_tenth_mm;
    if (place.cell.drift_tenth_mm > drift_limit)
        deny(findings, Reason::memory_uncertain, place, place.cell.drift_tenth_mm, drift_limit);
    check_below(scene,
                place,
                Side::up,
                over.low_tenth_mm + scene.lift_tenth_mm,
                Reason::body_clearance,
                findings);
    check_overhead(
        scene, place, over.high_tenth_mm + scene.lift_tenth_mm, Reason::body_clearance, findings);
}

/// Requires that no drop shows in or just beyond the drop band of a foot: the map can show ground
/// beyond the edge of a drop. A cell shows a drop if it lies lower than `drop`, or if it may lie
/// lower than `drop` plus the depth that a foot tolerates (75 mm for the REX, the lowest kerb), or
/// if lines of sight over an unknown cell do.
void check_edges(const Scene& scene, const FootSweep& foot, Findings& findings) noexcept {
    const GateLimits& limits = scene.machine.limits;
    const std::int64_t drop = limits.drop_tenth_mm;
    const auto kerb = static_cast<double>(drop + limits.patch_residual_tenth_mm);
    grid::for_each_overlapped_cell(
        foot.edges, scene.ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
            const Place place{scene.ground.cell(ix, iy), ix, iy, foot.foot};
            const std::int64_t ground = scene.stance.plane.at(ix, iy);
            if (!place.cell.known()) {
                if (scene.ground.is_below(ix, iy, ground - drop))
                    deny(findings, Reason::drop_off, place, drop, drop);
                return true;
            }
            const std::int64_t fall = ground - place.cell.height_tenth_mm;
            if (fall > drop) {
                deny(findings, Reason::drop_off, place, fall, drop);
            } else if (!(static_cast<double>(fall) +
                             limits.sigma_factor * static_cast<double>(place.cell.sigma_tenth_mm) <=
                         kerb)) {
                deny(findings, Reason::not_resolvable, place, place.cell.sigma_tenth_mm, drop);
            }
            return true;
        });
}

}  // namespace

Finding finding_at(std::int64_t ix,
                   std::int64_t iy,
                   Foot foot,
                   std::int64_t value_tenth_mm,
                   std::int64_t limit_tenth_mm) noexcept {
    return {ix, iy, value_tenth_mm, limit_tenth_mm, value_tenth_mm, foot};
}

ReachableSurfaces surfaces_of_stance(const Scene& scene) noexcept {
    ReachableSurfaces reachable;
    const std::int64_t step = scene.machine.limits.swing_clearance_tenth_mm;
    for (const FootSweep& foot : scene.sweep.feet) {
        grid::for_each_overlapped_cell(
            foot.stance, scene.ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
                const GroundCell cell = scene.ground.cell(ix, iy);
                const std::int64_t rise = cell.height_tenth_mm - scene.stance.plane.at(ix, iy);
                if (cell.knowledge == Knowledge::measured && rise >= -step && rise <= step)
                    reachable.add(cell.component);
                return true;
            });
    }
    reachable.add_beside_attested(scene.ground, scene.machine.limits.swing_clearance_tenth_mm);
    return reachable;
}

void check_stance(const Scene& scene, Findings& findings) noexcept {
    const GateLimits& limits = scene.machine.limits;
    for (const FootSweep& foot : scene.sweep.feet) {
        const auto test = [&](const Place& place) {
            check_below(scene, place, Side::down, limits.drop_tenth_mm, Reason::drop_off, findings);
        };
        check_region(scene, foot.stance, foot.foot, findings, test, kNothing);
    }
}

void check_corridors(const Scene& scene, Findings& findings) noexcept {
    const std::int64_t height = scene.machine.limits.swing_clearance_tenth_mm + scene.lift_tenth_mm;
    const std::int64_t lifted = scene.machine.body.lower_edge_tenth_mm() + height;
    for (const FootSweep& foot : scene.sweep.feet) {
        const auto test = [&](const Place& place) {
            check_below(scene, place, Side::up, height, Reason::corridor_blocked, findings);
            check_overhead(scene, place, lifted, Reason::corridor_blocked, findings);
        };
        if (scene.movement.movement_class == MovementClass::walk) {
            check_region(scene, foot.corridor, foot.foot, findings, test, kNothing);
            continue;
        }
        const NosingLines lines(scene.ground, scene.machine.limits, foot.corridor, kBesideTenthMm);
        const auto sharpen = [&](Place& place) { lines.sharpen(place.ix, place.iy, place.cell); };
        check_region(scene, foot.corridor, foot.foot, findings, test, kNothing, sharpen);
    }
}

void check_body_on_stairs(const Scene& scene, Findings& findings) noexcept {
    UnknownBelowBody unknown(scene);
    const std::span<const BodyPart> parts = scene.machine.body.all();
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const grid::FixedConvex& way = scene.sweep.body[i].way;
        const NosingLines lines(scene.ground, scene.machine.limits, way, kBesideTenthMm);
        const BodyOver over{parts[i].low_tenth_mm, parts[i].high_tenth_mm};
        grid::for_each_overlapped_cell(
            way, scene.ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
                Place place{scene.ground.cell(ix, iy), ix, iy, Foot::none};
                if (!place.cell.known() && unknown.is_free(ix, iy)) return true;
                count(place.cell, findings.evidence);
                if (place.cell.known()) {
                    lines.sharpen(ix, iy, place.cell);
                    check_body_cell(scene, place, over, findings);
                    return true;
                }
                deny(findings, reason_of_unknown(place.cell.knowledge), place, 0, 0);
                return place.cell.knowledge != Knowledge::outside;
            });
    }
}

void check_body(const Scene& scene, Findings& findings) noexcept {
    const std::span<const BodyPart> parts = scene.machine.body.all();
    const grid::FixedGrid& grid = scene.ground.grid();
    std::array<grid::RowRuns, Body::kMaxParts> areas;
    grid::FixedRun rows{INT64_MAX, INT64_MIN};
    for (std::size_t i = 0; i < parts.size(); ++i) {
        areas[i] = {scene.sweep.body[i].way, grid};
        rows = {std::min(rows.first, areas[i].rows().first),
                std::max(rows.last, areas[i].rows().last)};
    }
    UnknownBelowBody unknown(scene);
    // The parts of the body lie above each other. So each cell is tested once for all parts above
    // it.
    for (std::int64_t iy = rows.first; iy <= rows.last; ++iy) {
        std::array<grid::FixedRun, Body::kMaxParts> runs;
        grid::FixedRun all{INT64_MAX, INT64_MIN};
        for (std::size_t i = 0; i < parts.size(); ++i) {
            runs[i] = areas[i].run(iy);
            if (runs[i].last < runs[i].first) continue;
            all = {std::min(all.first, runs[i].first), std::max(all.last, runs[i].last)};
        }
        for (std::int64_t ix = all.first; ix <= all.last;) {
            const BodyOver over = body_over(parts, runs, ix);
            if (!over.any()) {
                ix = over.last + 1;
                continue;
            }
            for (; ix <= over.last; ++ix) {
                const Place place{scene.ground.cell(ix, iy), ix, iy, Foot::none};
                if (!place.cell.known() && unknown.is_free(ix, iy)) continue;
                count(place.cell, findings.evidence);
                if (place.cell.known()) {
                    check_body_cell(scene, place, over, findings);
                    continue;
                }
                deny(findings, reason_of_unknown(place.cell.knowledge), place, 0, 0);
                // Further cells outside the map add nothing.
                if (place.cell.knowledge == Knowledge::outside) return;
            }
        }
    }
}

void check_bands(const Scene& scene, Findings& findings) noexcept {
    const GateLimits& limits = scene.machine.limits;
    for (const FootSweep& foot : scene.sweep.feet) {
        const auto test = [&](const Place& place) {
            check_below(scene, place, Side::down, limits.drop_tenth_mm, Reason::drop_off, findings);
        };
        // A table top has drop evidence at its rim, but the floor beside it is no drop for a foot
        // on the floor. So drop evidence does not count on cells that are too high for a foot.
        const auto evidence = [&](const Place& place) {
            const bool above =
                place.cell.known() && rise_of(scene, place) > limits.swing_clearance_tenth_mm;
            if (place.cell.drop_evidence >= limits.drop_evidence && !above)
                deny(findings, Reason::drop_off, place, 0, limits.drop_tenth_mm);
        };
        check_region(scene, foot.band, foot.foot, findings, test, evidence);
    }
    for (const FootSweep& foot : scene.sweep.feet) check_edges(scene, foot, findings);
}

}  // namespace surefoot::gate
