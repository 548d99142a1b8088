// SPDX-License-Identifier: Apache-2.0
#include "studies/suite/suite_verdicts.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "service/live/ground_box.hpp"
#include "studies/runs/offline_map.hpp"
#include "surefoot/gate/verdict_text.hpp"
#include "surefoot/grid/whole_cells.hpp"
#include "surefoot/sim/safety_oracle/seen_ground.hpp"

namespace surefoot::app {
namespace {

/// One stance in the world frame and in odom. The two frames coincide at the start and drift apart.
struct Stance {
    Pose T_world_body;
    double x_odom_m = 0.0;
    double y_odom_m = 0.0;
    double yaw_odom_rad = 0.0;
};

std::vector<Stance> stances_around(const Pose& T_world_body,
                                   const grid::MapSnapshot& map,
                                   double reach_m) {
    constexpr double kGrid_m = 0.2;
    const gate::Query here = gate::query_at_body(0, map);
    const double yaw_odom_rad = std::atan2(here.sin_yaw, here.cos_yaw);
    const double turn_rad = yaw_rad(T_world_body) - yaw_odom_rad;
    const int steps = grid::whole_cells(reach_m / kGrid_m);
    std::vector<Stance> stances;
    for (int i = -steps; i <= steps; ++i) {
        for (int j = -steps; j <= steps; ++j) {
            const Eigen::Vector2d offset_odom_m(i * kGrid_m, j * kGrid_m);
            if (offset_odom_m.norm() > reach_m) continue;
            Stance stance;
            stance.x_odom_m = 1e-4 * static_cast<double>(here.x_tenth_mm) + offset_odom_m.x();
            stance.y_odom_m = 1e-4 * static_cast<double>(here.y_tenth_mm) + offset_odom_m.y();
            stance.yaw_odom_rad = yaw_odom_rad;
            stance.T_world_body = T_world_body;
            stance.T_world_body.translation_m.head<2>() +=
                Eigen::Rotation2Dd(turn_rad) * offset_odom_m;
            stances.push_back(stance);
        }
    }
    return stances;
}

/// Returns the question, with an attestation for the ground under the standing feet.
gate::Query query_of(const Machine& machine,
                     const grid::MapSnapshot& map,
                     const Stance& stance,
                     int command) {
    gate::Query query = gate::make_query(static_cast<std::uint8_t>(command),
                                         stance.x_odom_m,
                                         stance.y_odom_m,
                                         std::cos(stance.yaw_odom_rad),
                                         std::sin(stance.yaw_odom_rad));
    std::vector<std::string> assumed;
    if (const auto area = attest_start(machine, query, map, -1.0, assumed)) query.attested = *area;
    return query;
}

std::string missed_sentence(const GateQuestion& question) {
    const Eigen::Vector3d& at = question.T_world_body.translation_m;
    const Eigen::Vector3d& where = question.truth.dangers.front().where_m;
    return fmt::format(
        "the dangerous movement {} from ({:.2f}, {:.2f}) m, yaw {:.2f} rad, was allowed: {} "
        "(danger at {:.3f}, {:.3f}, {:.3f} m)",
        question.query.command,
        at.x(),
        at.y(),
        yaw_rad(question.T_world_body),
        question.truth.sentence(),
        where.x(),
        where.y(),
        where.z());
}

}  // namespace

std::vector<std::string_view> names_of(const sim::SafetyAnswer& answer) {
    std::vector<std::string_view> names;
    for (const sim::Finding& finding : answer.dangers)
        names.emplace_back(sim::to_string(finding.danger));
    return names;
}

void VerdictCounts::add(bool truly_safe, bool clear_cut, InView in_view, bool allowed) {
    if (!clear_cut) {
        ++borderline;
        borderline_ok += allowed ? 1 : 0;
        borderline_missed += allowed && !truly_safe ? 1 : 0;
    } else if (truly_safe) {
        ++safe;
        safe_ok += allowed ? 1 : 0;
        seen += in_view != InView::none ? 1 : 0;
        seen_ok += in_view != InView::none && allowed ? 1 : 0;
        body_seen += in_view == InView::with_body ? 1 : 0;
        body_seen_ok += in_view == InView::with_body && allowed ? 1 : 0;
    } else {
        ++unsafe;
        unsafe_ok += allowed ? 1 : 0;
    }
}

void VerdictTallies::add(TallyKey by, std::span<const std::string_view> words) {
    for (const std::string_view word : words)
        add({by, std::string(word), 1, words.size() == 1 ? 1 : 0});
}

void VerdictTallies::add(const VerdictTally& tally) {
    VerdictTally& known = of(tally.by, tally.name);
    known.named += tally.named;
    known.alone += tally.alone;
}

void VerdictTallies::add_refusal(const gate::Verdict& verdict, bool seen) {
    const std::vector<std::string_view> reasons = gate::names_of(verdict.reasons);
    add(TallyKey::reason, reasons);
    if (seen) add(TallyKey::seen, reasons);
    add(TallyKey::proof, gate::unproven_names(verdict.evidence));
}

VerdictTally& VerdictTallies::of(TallyKey by, std::string_view name) {
    const auto at = std::lower_bound(
        all_.begin(), all_.end(), std::tie(by, name), [](const VerdictTally& a, const auto& b) {
            return std::tuple<TallyKey, std::string_view>(a.by, a.name) < b;
        });
    if (at != all_.end() && at->by == by && at->name == name) return *at;
    return *all_.insert(at, {by, std::string(name), 0, 0});
}

std::vector<GateQuestion> questions_around(const sim::SceneTruth& truth,
                                           const StampedPose& here,
                                           const Machine& machine,
                                           const grid::MapSnapshot& map,
                                           double reach_m) {
    Serial serial;
    const sim::SeenGround ground(
        truth, here.time_ns, machine, here.T_world_body.translation_m.head<2>(), reach_m, serial);
    std::vector<GateQuestion> questions;
    for (const Stance& stance : stances_around(here.T_world_body, map, reach_m)) {
        const Pose& T_world_body = stance.T_world_body;
        for (int command = 1; command < Machine::kMovementCodes; ++command) {
            if (!machine.movements[static_cast<std::size_t>(command)].configured) continue;
            sim::SafetyAnswer answer = sim::judge(truth.scene, machine, T_world_body, command);
            // Skips poses at which the machine cannot stand.
            if (answer.has(sim::Danger::no_stance) || answer.has(sim::Danger::not_level_here))
                continue;
            const gate::Query query = query_of(machine, map, stance, command);
            const sim::VouchedGround vouched{T_world_body.translation_m.head<2>(),
                                             kTenthMm_m * query.attested.radius_tenth_mm};
            InView in_view = InView::none;
            if (answer.safe && ground.holds_zone(machine, T_world_body, command, vouched)) {
                in_view = ground.holds_body(machine, T_world_body, command, vouched)
                              ? InView::with_body
                              : InView::zone;
            }
            questions.push_back({query, T_world_body, in_view, std::move(answer)});
        }
    }
    return questions;
}

AroundAnswers compare_verdicts(const sim::SceneTruth& truth,
                               const StampedPose& here,
                               const Machine& machine,
                               const grid::MapSnapshot& map,
                               double reach_m) {
    AroundAnswers answers;
    for (const GateQuestion& question : questions_around(truth, here, machine, map, reach_m)) {
        const sim::SafetyAnswer& answer = question.truth;
        const gate::Verdict verdict = decide_offline(machine, question.query, map);
        const bool ok = verdict.decision == gate::Decision::ok;
        answers.counts.add(answer.safe, answer.clear_cut, question.in_view, ok);
        if (!answer.clear_cut || answer.safe == ok) continue;
        if (answer.safe) {
            answers.tallies.add_refusal(verdict, question.in_view != InView::none);
            continue;
        }
        answers.tallies.add(TallyKey::danger, names_of(answer));
        answers.missed.push_back(missed_sentence(question));
    }
    return answers;
}

}  // namespace surefoot::app
