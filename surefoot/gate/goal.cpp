// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/goal.hpp"

#include "surefoot/gate/findings.hpp"
#include "surefoot/gate/footprints.hpp"
#include "surefoot/gate/ground.hpp"
#include "surefoot/gate/regions.hpp"

namespace surefoot::gate {
namespace {

/// Requires that the surfaces under the feet at the goal are connected to the surfaces under the
/// feet now.
void check_joined(const Machine& machine,
                  const Query& here,
                  const Sweep& there,
                  const grid::MapSnapshot& map,
                  Findings& findings) noexcept {
    const Ground ground(map, here, machine.limits);
    const Movement stay;
    const Sweep sweep = sweep_of(
        machine, fixed_pose(here.x_tenth_mm, here.y_tenth_mm, here.cos_yaw, here.sin_yaw), stay);
    if (!ground.is_intact(ground.zone_of(sweep))) findings.deny(Reason::internal);
    const Stance stance = find_stance(ground, here, sweep, false);
    if (!stance.known) {
        findings.deny(Reason::disconnected);
        return;
    }
    const ReachableSurfaces reachable = surfaces_of_stance({machine, stay, ground, sweep, stance});
    for (const FootSweep& foot : there.feet) {
        grid::for_each_overlapped_cell(
            foot.stance, ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
                const GroundCell cell = ground.cell(ix, iy);
                if (cell.knowledge == Knowledge::measured && !reachable.contains(cell.component))
                    findings.deny(Reason::disconnected, finding_at(ix, iy, foot.foot, 0, 0));
                return true;
            });
    }
}

}  // namespace

Verdict judge_goal(const Machine& machine,
                   const Query& here,
                   const GoalPose& goal,
                   const grid::MapSnapshot& map,
                   const GateHealth& health,
                   std::int64_t now_ns) noexcept {
    constexpr std::uint8_t kStay = 1;
    Machine standing = machine;  // this machine has only one movement: to stay in place
    standing.movements = {};
    standing.movements[kStay].configured = true;
    standing.limits.step[static_cast<std::size_t>(MovementClass::walk)].enabled = true;
    Query there = here;
    there.command = kStay;
    there.x_tenth_mm = goal.x_tenth_mm;
    there.y_tenth_mm = goal.y_tenth_mm;
    there.cos_yaw = goal.cos_yaw;
    there.sin_yaw = goal.sin_yaw;
    there.stance_source = StanceHeight::map;
    Verdict verdict = decide(standing, there, map, health, now_ns);
    verdict.command = 0;
    if (verdict.decision == Decision::ok) {
        Findings findings;
        check_joined(
            machine,
            here,
            sweep_of(standing,
                     fixed_pose(goal.x_tenth_mm, goal.y_tenth_mm, goal.cos_yaw, goal.sin_yaw),
                     standing.movements[kStay]),
            map,
            findings);
        if (!findings.reasons().empty()) {
            verdict.reasons = findings.reasons();
            verdict.primary = verdict.reasons.primary();
            verdict.decision =
                is_error(verdict.primary) ? Decision::error : Decision::not_traversable;
            show_worst_cell(map, findings, verdict.primary, verdict.evidence);
        }
    }
    verdict.valid_until_ns = verdict.decided_ns;
    return verdict;
}

}  // namespace surefoot::gate
