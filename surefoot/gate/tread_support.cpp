// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/tread_support.hpp"

#include <algorithm>
#include <optional>

#include "surefoot/gate/foot_support.hpp"
#include "surefoot/gate/nosing_lines.hpp"

namespace surefoot::gate {
namespace {

using grid::FixedPoint;

const GroundBox& box_of(const Scene& scene, const FootSweep& foot) noexcept {
    return foot.foot == Foot::left ? scene.machine.left_foot : scene.machine.right_foot;
}

const StepLimits& step_limits(const Scene& scene) noexcept {
    return scene.machine.limits.step[static_cast<std::size_t>(scene.movement.movement_class)];
}

/// The axes of a foot before or after the movement. Positions count from the middle of the foot and
/// are doubled: along = forward, across = to the left.
class FootAxes {
  public:
    struct Place {
        std::int64_t along = 0;
        std::int64_t across = 0;
    };

    FootAxes(const Scene& scene, const FootSweep& foot) noexcept
        : FootAxes(scene, foot, scene.sweep.target) {}
    FootAxes(const Scene& scene, const FootSweep& foot, const FixedPose& pose) noexcept
        : ground_(scene.ground),
          pose_(pose),
          middle_(to_odom(
              pose, box_of(scene, foot).center_x_tenth_mm, box_of(scene, foot).center_y_tenth_mm)),
          // A cell reaches half its side times (|cos| + |sin|) on each side of its centre.
          reach_(1 - grid::floor_div(
                         -(grid::magnitude(pose_.cos_yaw) + grid::magnitude(pose_.sin_yaw)) *
                             scene.ground.grid().side,
                         FixedPose::kOne)),
          length_(box_of(scene, foot).length_tenth_mm),
          width_(box_of(scene, foot).width_tenth_mm),
          ankle_(2 * scene.machine.ankle_from_heel_tenth_mm - length_),
          ankle_reach_(scene.machine.limits.patch_side_tenth_mm) {}

    /// Returns the position along the foot axes. `doubled`: position in odom relative to the middle
    /// of the foot, doubled.
    [[nodiscard]] Place place_of(FixedPoint doubled) const noexcept {
        return {rounded(doubled.x * pose_.cos_yaw + doubled.y * pose_.sin_yaw),
                rounded(doubled.y * pose_.cos_yaw - doubled.x * pose_.sin_yaw)};
    }
    [[nodiscard]] Place middle_of(std::int64_t ix, std::int64_t iy) const noexcept {
        return place_of(ground_.doubled_center(ix, iy, middle_));
    }
    [[nodiscard]] std::int64_t reach() const noexcept { return reach_; }
    [[nodiscard]] std::int64_t length() const noexcept { return length_; }  ///< doubled half length
    [[nodiscard]] std::int64_t width() const noexcept { return width_; }
    [[nodiscard]] std::int64_t ankle() const noexcept { return ankle_; }
    /// Returns half of the extent of the ankle area along the foot: half a patch, doubled.
    [[nodiscard]] std::int64_t ankle_reach() const noexcept { return ankle_reach_; }
    /// True if any part of a cell lies under the ankle or touches it.
    [[nodiscard]] bool touches_ankle(const Place& middle) const noexcept {
        return grid::magnitude(middle.along - ankle_) < ankle_reach_ + reach_;
    }
    /// Returns the distance of the nearest part of a cell from the foot, doubled. Negative = under
    /// the foot.
    [[nodiscard]] std::int64_t gap(const Place& middle) const noexcept {
        return std::max(grid::magnitude(middle.along) - length_,
                        grid::magnitude(middle.across) - width_) -
               reach_;
    }

  private:
    static std::int64_t rounded(std::int64_t fraction) noexcept {
        return grid::floor_div(fraction + FixedPose::kOne / 2, FixedPose::kOne);
    }

    const Ground& ground_;
    FixedPose pose_;
    FixedPoint middle_;
    std::int64_t reach_;
    std::int64_t length_;
    std::int64_t width_;
    std::int64_t ankle_;
    std::int64_t ankle_reach_;
};

/// Finds the mean height above the stance of the cells under the ankle.
void find_level(const Scene& scene, const FootSweep& foot, Tread& tread) noexcept {
    const FootAxes axes(scene, foot);
    std::int64_t sum = 0;
    std::int64_t count = 0;
    const bool all_known = grid::for_each_overlapped_cell(
        foot.landing, scene.ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
            if (grid::magnitude(axes.middle_of(ix, iy).along - axes.ankle()) > axes.ankle_reach())
                return true;
            const GroundCell cell = scene.ground.cell(ix, iy);
            sum += cell.height_tenth_mm - scene.stance.plane.height_tenth_mm;
            ++count;
            return cell.known();
        });
    tread.known = all_known && count > 0;
    if (tread.known) tread.rise_tenth_mm = grid::rounded_div(sum, count);
}

/// Finds, towards the toe and towards the heel, the start of the first ground that lies more than
/// `drop` below the tread. A cell with drop evidence is the last cell of the tread, unless it is
/// too high for a foot.
void find_edges(const Scene& scene, const FootSweep& foot, Tread& tread) noexcept {
    const GateLimits& limits = scene.machine.limits;
    const FootAxes axes(scene, foot);
    const auto begins = [&](const FootAxes::Place& middle, bool lower) {
        const std::int64_t from_middle = lower ? -axes.reach() : axes.reach();
        if (middle.along > axes.ankle())
            tread.toe_edge = std::min(tread.toe_edge, middle.along + from_middle);
        else
            tread.heel_edge = std::min(tread.heel_edge, -middle.along + from_middle);
    };
    grid::for_each_overlapped_cell(
        foot.band, scene.ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
            const GroundCell cell = scene.ground.cell(ix, iy);
            if (!cell.known()) return true;
            tread.drift_tenth_mm =
                std::max<std::int64_t>(tread.drift_tenth_mm, cell.drift_tenth_mm);
            const std::int64_t above =
                cell.height_tenth_mm - scene.stance.plane.height_tenth_mm - tread.rise_tenth_mm;
            if (above < -limits.drop_tenth_mm)
                begins(axes.middle_of(ix, iy), true);
            else if (cell.drop_evidence >= limits.drop_evidence &&
                     above <= limits.swing_clearance_tenth_mm)
                begins(axes.middle_of(ix, iy), false);
            return true;
        });
}

/// A cell of a drop band during its tests.
struct BandCell {
    const GroundCell& cell;
    Finding here;

    void deny(Findings& findings, Reason reason, std::int64_t value, std::int64_t limit) const {
        Finding finding = here;
        finding.value_tenth_mm = finding.severity = value;
        finding.limit_tenth_mm = limit;
        findings.deny(reason, finding);
    }
    /// Requires `value` below `limit` by `sigma_factor` sigma. Unlike in regions.cpp, no single
    /// cell may have a larger sigma.
    void check_below(const GateLimits& limits,
                     std::int64_t value,
                     std::int64_t limit,
                     Reason reason,
                     Findings& findings) const {
        if (value > limit) {
            deny(findings, reason, value, limit);
        } else if (!(limits.sigma_factor * static_cast<double>(cell.sigma_tenth_mm) <=
                     static_cast<double>(limit - value))) {
            deny(findings, Reason::not_resolvable, cell.sigma_tenth_mm, limit - value);
        }
    }
    /// Tests that the cell is known, certain and not drifted. Returns false if the cell has no
    /// usable height.
    [[nodiscard]] bool check_knowledge(const GateLimits& limits, Findings& findings) const {
        ++findings.evidence.cells;
        if (!cell.known()) {
            deny(findings, reason_of_unknown(cell.knowledge), 0, 0);
            return false;
        }
        Evidence& evidence = findings.evidence;
        ++evidence.known_cells;
        if (cell.knowledge == Knowledge::attested) ++evidence.attested_cells;
        evidence.max_drift_tenth_mm =
            std::max<std::int64_t>(evidence.max_drift_tenth_mm, cell.drift_tenth_mm);
        evidence.min_clearance_tenth_mm =
            std::min<std::int64_t>(evidence.min_clearance_tenth_mm, cell.clearance_tenth_mm);
        if (cell.sigma_tenth_mm > limits.cell_sigma_tenth_mm)
            deny(findings, Reason::not_resolvable, cell.sigma_tenth_mm, limits.cell_sigma_tenth_mm);
        if (cell.drift_tenth_mm > limits.drift_tenth_mm)
            deny(findings, Reason::memory_uncertain, cell.drift_tenth_mm, limits.drift_tenth_mm);
        return true;
    }
};

void check_band(const Scene& scene,
                const FootSweep& foot,
                const Tread& tread,
                Findings& findings) noexcept {
    const GateLimits& limits = scene.machine.limits;
    const FootAxes axes(scene, foot);
    const std::int64_t drop = limits.drop_tenth_mm;
    const grid::FixedConvex margin = grid::convex_hull(corners_of(
        box_of(scene, foot), scene.sweep.target, limits.foot_margin_tenth_mm + kBesideTenthMm));
    const NosingLines lines(scene.ground, limits, margin, kBesideTenthMm);
    grid::for_each_overlapped_cell(
        foot.band, scene.ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
            const GroundCell cell = scene.ground.cell(ix, iy);
            const BandCell asked{cell, finding_at(ix, iy, foot.foot, 0, 0)};
            if (!asked.check_knowledge(limits, findings))
                return cell.knowledge != Knowledge::outside;
            const std::int64_t above =
                cell.height_tenth_mm - scene.stance.plane.height_tenth_mm - tread.rise_tenth_mm;
            const FootAxes::Place middle = axes.middle_of(ix, iy);
            const std::int64_t near = limits.foot_margin_tenth_mm + kBesideTenthMm +
                                      times_up(limits.sigma_factor, cell.drift_tenth_mm);
            if (axes.gap(middle) < 2 * near) {
                GroundCell sharp = cell;
                lines.sharpen(ix, iy, sharp);
                const BandCell beside{sharp, asked.here};
                beside.check_below(limits,
                                   above + sharp.height_tenth_mm - cell.height_tenth_mm,
                                   limits.swing_clearance_tenth_mm,
                                   Reason::corridor_blocked,
                                   findings);
            }
            if (above >= -drop) {
                asked.check_below(limits, -above, drop, Reason::drop_off, findings);
            } else if (axes.touches_ankle(middle)) {
                asked.deny(findings, Reason::drop_off, -above, drop);
            } else {
                asked.check_below(
                    limits, -above, step_limits(scene).down_tenth_mm, Reason::drop_off, findings);
            }
            return true;
        });
    // A ridge does not count as a tread: it has lower ground at both ends of the foot.
    if (tread.toe_edge != Tread::kNone && tread.heel_edge != Tread::kNone)
        findings.deny(Reason::drop_off);
}

/// The ends of the supported part of a foot, from the middle, doubled. The heel end counts
/// backward.
struct Carried {
    std::int64_t toe = 0;
    std::int64_t heel = 0;

    [[nodiscard]] std::int64_t length() const noexcept { return toe + heel; }
};

bool is_enough(const Carried& carried, const FootAxes& axes, const GateLimits& limits) noexcept {
    const std::int64_t most_over = 2 * limits.tread_overhang_tenth_mm;
    return carried.length() * 1'000 >= limits.tread_share_permille * 2 * axes.length() &&
           axes.length() - carried.toe <= most_over && axes.length() - carried.heel <= most_over &&
           carried.toe >= axes.ankle() + axes.ankle_reach() &&
           carried.heel >= -axes.ankle() + axes.ankle_reach();
}

/// Returns the shortest distance from the middle of the foot to the nosing line of the snapshot,
/// minus `sigma_factor` sigma of the line. Drift is not subtracted. Empty if no line of the
/// snapshot is this nosing. The distance is doubled, like the edges of `Tread`.
std::optional<std::int64_t> nosing_line(const Scene& scene,
                                        const FootSweep& foot,
                                        const FootAxes& axes,
                                        const Tread& tread,
                                        bool at_toe) noexcept {
    const GateLimits& limits = scene.machine.limits;
    const grid::FixedGrid& grid = scene.ground.grid();
    std::optional<std::int64_t> nearest;
    for (const grid::SnapshotEdge& edge : scene.ground.edges()) {
        const std::int64_t above =
            edge.upper_tenth_mm - scene.stance.plane.height_tenth_mm - tread.rise_tenth_mm;
        if (!is_nosing(edge, limits) || grid::magnitude(above) > limits.patch_residual_tenth_mm)
            continue;
        const auto end = [&](std::int32_t x, std::int32_t y) {
            return axes.place_of({2 * (grid.origin_x + x - foot.landing_center.x),
                                  2 * (grid.origin_y + y - foot.landing_center.y)});
        };
        FootAxes::Place from = end(edge.from_x_tenth_mm, edge.from_y_tenth_mm);
        FootAxes::Place to = end(edge.to_x_tenth_mm, edge.to_y_tenth_mm);
        // The lower ground lies on the right of the line, so at the toe the line runs to the left.
        if (!at_toe) std::swap(from, to);
        if (!(from.across <= -axes.width() && to.across >= axes.width())) continue;
        const std::int64_t sign = at_toe ? 1 : -1;
        const auto along_at = [&](std::int64_t across) {
            return grid::floor_div(sign * (from.along * (to.across - from.across) +
                                           (to.along - from.along) * (across - from.across)),
                                   to.across - from.across);
        };
        const std::int64_t reach = std::min(along_at(-axes.width()), along_at(axes.width())) -
                                   2 * times_up(limits.sigma_factor, edge.across_sigma_tenth_mm);
        if (!nearest || reach < *nearest) nearest = reach;
    }
    return nearest;
}

/// Returns one end of the tread minus its uncertainty. A line may reduce the uncertainty of a cell,
/// but the cells decide where the tread ends.
std::int64_t sure_end(const Scene& scene,
                      const FootSweep& foot,
                      const FootAxes& axes,
                      const Tread& tread,
                      bool at_toe) noexcept {
    const std::int64_t edge = at_toe ? tread.toe_edge : tread.heel_edge;
    if (edge == Tread::kNone) return axes.length();
    std::int64_t end = edge - 2 * kBesideTenthMm;
    if (const auto line = nosing_line(scene, foot, axes, tread, at_toe))
        end = std::max(end, std::min(edge, *line));
    end -= 2 * times_up(scene.machine.limits.sigma_factor, tread.drift_tenth_mm);
    return std::min(axes.length(), end);
}

/// Tests the supported part of the foot with the rules of a whole foot.
void check_carried(const Scene& scene,
                   const FootSweep& foot,
                   const GroundBox& box,
                   const Carried& carried,
                   const ReachableSurfaces& reachable,
                   Findings& findings) noexcept {
    GroundBox part = box;
    part.center_x_tenth_mm += static_cast<std::int32_t>((carried.toe - carried.heel) / 4);
    part.length_tenth_mm = static_cast<std::int32_t>(carried.length() / 2);
    FootSweep landed = foot;
    const FixedPose& target = scene.sweep.target;
    landed.landing = grid::convex_hull(corners_of(part, target, 0));
    landed.landing_center = to_odom(target, part.center_x_tenth_mm, part.center_y_tenth_mm);
    check_landing(scene, landed, part, reachable, findings);
}

}  // namespace

void check_stance_on_treads(const Scene& scene, Findings& findings) noexcept {
    const GateLimits& limits = scene.machine.limits;
    for (const FootSweep& foot : scene.sweep.feet) {
        const FootAxes axes(scene, foot, scene.sweep.start);
        grid::for_each_overlapped_cell(
            foot.stance, scene.ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
                if (grid::magnitude(axes.middle_of(ix, iy).along - axes.ankle()) >
                    axes.ankle_reach())
                    return true;
                const GroundCell cell = scene.ground.cell(ix, iy);
                const BandCell asked{cell, finding_at(ix, iy, foot.foot, 0, 0)};
                if (!asked.check_knowledge(limits, findings))
                    return cell.knowledge != Knowledge::outside;
                const std::int64_t below =
                    scene.stance.plane.height_tenth_mm - cell.height_tenth_mm;
                asked.check_below(limits, below, limits.drop_tenth_mm, Reason::drop_off, findings);
                asked.check_below(
                    limits, -below, limits.drop_tenth_mm, Reason::step_too_high, findings);
                return true;
            });
    }
}

Treads find_treads(const Scene& scene) noexcept {
    Treads treads;
    for (std::size_t i = 0; i < treads.size(); ++i) {
        find_level(scene, scene.sweep.feet[i], treads[i]);
        if (treads[i].known) find_edges(scene, scene.sweep.feet[i], treads[i]);
    }
    return treads;
}

std::int64_t lift_of(const Treads& treads) noexcept {
    return std::max<std::int64_t>({0, treads[0].rise_tenth_mm, treads[1].rise_tenth_mm});
}

void check_body_lowered(const Scene& scene, const Treads& treads, Findings& findings) noexcept {
    const std::int64_t rise = std::min(treads[0].rise_tenth_mm, treads[1].rise_tenth_mm);
    if (rise >= 0) return;
    const grid::FixedGrid& grid = scene.ground.grid();
    const std::int64_t margin = scene.machine.body.sway_tenth_mm + kBesideTenthMm;
    for (const BodyPart& part : scene.machine.body.all()) {
        const grid::FixedConvex area =
            grid::convex_hull(corners_of(part.box, scene.sweep.target, margin));
        const NosingLines lines(scene.ground, scene.machine.limits, area, kBesideTenthMm);
        grid::for_each_overlapped_cell(area, grid, [&](std::int64_t ix, std::int64_t iy) {
            GroundCell cell = scene.ground.cell(ix, iy);
            lines.sharpen(ix, iy, cell);
            const std::int64_t above =
                cell.height_tenth_mm - scene.stance.plane.height_tenth_mm - rise;
            if (cell.known() && above > part.low_tenth_mm)
                findings.deny(Reason::body_clearance,
                              finding_at(ix, iy, Foot::none, above, part.low_tenth_mm));
            return true;
        });
    }
}

void check_tread_bands(const Scene& scene, const Treads& treads, Findings& findings) noexcept {
    for (std::size_t i = 0; i < treads.size(); ++i)
        check_band(scene, scene.sweep.feet[i], treads[i], findings);
    const std::int64_t between = grid::magnitude(treads[0].rise_tenth_mm - treads[1].rise_tenth_mm);
    if (between > scene.machine.limits.patch_residual_tenth_mm) findings.deny(Reason::roughness);
}

void check_tread(const Scene& scene,
                 const FootSweep& foot,
                 const GroundBox& box,
                 const Tread& tread,
                 const ReachableSurfaces& reachable,
                 Findings& findings) noexcept {
    if (!tread.known) {
        findings.deny(reason_of_unknown(Knowledge::unknown));
        return;
    }
    const GateLimits& limits = scene.machine.limits;
    const FootAxes axes(scene, foot);
    const Carried seen{std::min(axes.length(), tread.toe_edge),
                       std::min(axes.length(), tread.heel_edge)};
    const Carried sure{sure_end(scene, foot, axes, tread, true),
                       sure_end(scene, foot, axes, tread, false)};
    if (is_enough(sure, axes, limits)) {
        check_carried(scene, foot, box, sure, reachable, findings);
        return;
    }
    const bool seems_enough = is_enough(seen, axes, limits);
    const grid::FixedGrid& grid = scene.ground.grid();
    const std::int64_t carried = (seems_enough ? sure : seen).length() / 2;
    const std::int64_t wanted =
        std::int64_t{limits.tread_share_permille} * box.length_tenth_mm / 1'000;
    Finding finding = finding_at(grid::floor_div(foot.landing_center.x - grid.origin_x, grid.side),
                                 grid::floor_div(foot.landing_center.y - grid.origin_y, grid.side),
                                 foot.foot,
                                 std::max<std::int64_t>(0, carried),
                                 wanted);
    finding.severity = -carried;
    findings.deny(seems_enough ? Reason::edge_margin : Reason::support_area, finding);
}

void add_a_step_away(const Scene& scene, ReachableSurfaces& reachable) noexcept {
    constexpr std::int64_t kBetween = 2;  // the cell of a riser can have any height
    const ReachableSurfaces here = reachable;
    const StepLimits& step = step_limits(scene);
    const Ground& ground = scene.ground;
    for (const FootSweep& foot : scene.sweep.feet) {
        const grid::RowRuns way(foot.corridor, ground.grid());
        const auto join = [&](const GroundCell& cell, std::int64_t ix, std::int64_t iy) {
            if (!way.run(iy).contains(ix)) return;
            const GroundCell other = ground.cell(ix, iy);
            if (other.knowledge != Knowledge::measured || cell.component == other.component) return;
            const bool from_cell = here.contains(cell.component);
            if (from_cell == here.contains(other.component)) return;
            const GroundCell& low = from_cell ? cell : other;  // the cell on the reachable surface
            const GroundCell& next = from_cell ? other : cell;
            const std::int64_t rise = next.height_tenth_mm - low.height_tenth_mm;
            if (rise <= step.up_tenth_mm && -rise <= step.down_tenth_mm)
                reachable.add(next.component);
        };
        grid::for_each_overlapped_cell(
            foot.corridor, ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
                const GroundCell cell = ground.cell(ix, iy);
                for (std::int64_t i = 1; cell.knowledge == Knowledge::measured && i <= kBetween;
                     ++i) {
                    join(cell, ix + i, iy);
                    join(cell, ix, iy + i);
                }
                return true;
            });
    }
}

}  // namespace surefoot::gate
