// SPDX-License-Identifier: Apache-2.0
#include "studies/suite/suite_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "service/live/ground_box.hpp"
#include "studies/runs/offline_map.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/gate/verdict_text.hpp"
#include "surefoot/grid/whole_cells.hpp"
#include "surefoot/sim/safety_oracle/safety_oracle.hpp"
#include "surefoot/sim/safety_oracle/seen_ground.hpp"

namespace surefoot::app {
namespace {

/// Returns the radius around a stance within which the ground is level and at the height of the
/// stance. An operator could attest this area.
double level_radius_m(const sim::Scene& scene, const Eigen::Vector3d& body_m, double limit_m) {
    constexpr double kSpacing_m = 0.02;
    constexpr double kLevel_m = 0.01;  // half of the smallest kerb that a foot may meet
    const auto here = scene.height_at(body_m.x(), body_m.y());
    if (!here) return 0.0;
    double radius_m = limit_m;
    const int reach = grid::whole_cells(std::ceil(limit_m / kSpacing_m));
    for (int i = -reach; i <= reach; ++i) {
        for (int j = -reach; j <= reach; ++j) {
            const double distance_m = kSpacing_m * std::hypot(i, j);
            if (distance_m >= radius_m) continue;
            const auto there =
                scene.height_at(body_m.x() + i * kSpacing_m, body_m.y() + j * kSpacing_m);
            if (there && std::abs(there->z_m - here->z_m) <= kLevel_m) continue;
            radius_m = std::max(0.0, distance_m - kSpacing_m);
        }
    }
    return radius_m;
}

bool inside(const gate::AttestedArea& area, const gate::Query& query) {
    const auto dx = static_cast<double>(query.x_tenth_mm - area.center_x_tenth_mm);
    const auto dy = static_cast<double>(query.y_tenth_mm - area.center_y_tenth_mm);
    return std::hypot(dx, dy) <= area.radius_tenth_mm;
}

std::string joined(const std::vector<std::string_view>& names) {
    return fmt::format("{}", fmt::join(names, "|"));
}

}  // namespace

VerdictCounts count_verdicts(std::span<const SuiteStep> steps) {
    VerdictCounts counts;
    for (const SuiteStep& step : steps)
        counts.add(
            step.safe, step.clear_cut, step.seen ? InView::zone : InView::none, step.allowed());
    return counts;
}

bool StepQuestions::due(std::int64_t frame_ns) const {
    if (steps_.size() >= truth_.steps.size()) return false;
    const std::int64_t start_ns =
        truth_.start_ns + ns_from_seconds(truth_.steps[steps_.size()].start_s);
    const auto next = std::upper_bound(
        truth_.trajectory.begin(),
        truth_.trajectory.end(),
        frame_ns,
        [](std::int64_t time_ns, const StampedPose& pose) { return time_ns < pose.time_ns; });
    return next == truth_.trajectory.end() ? start_ns <= frame_ns : start_ns < next->time_ns;
}

gate::Query StepQuestions::query_of(const sim::StepEvent& step, const grid::MapSnapshot& map) {
    gate::Query query = gate::query_at_body(static_cast<std::uint8_t>(step.command), map);
    if (steps_.empty()) {
        const double limit_m = kTenthMm_m * machine_.limits.attestation_radius_tenth_mm;
        const double radius_m =
            level_radius_m(truth_.scene, step.T_world_before.translation_m, limit_m);
        std::vector<std::string> assumed;
        const auto area = attest_start(machine_, query, map, radius_m, assumed);
        if (area && radius_m > 0.0) attested_ = *area;
    }
    if (attested_ && !inside(*attested_, query)) attested_.reset();
    if (attested_) query.attested = *attested_;
    return query;
}

bool StepQuestions::is_seen(const sim::StepEvent& step, const gate::Query& query) const {
    const Eigen::Vector2d here_m = step.T_world_before.translation_m.head<2>();
    sim::VouchedGround vouched;
    if (query.attested.active) {
        // The attestation was given before the first step. The machine has hardly drifted since.
        vouched = {truth_.steps.front().T_world_before.translation_m.head<2>(),
                   kTenthMm_m * query.attested.radius_tenth_mm};
    }
    Serial serial;
    const sim::SeenGround seen(
        truth_, truth_.start_ns + ns_from_seconds(step.start_s), machine_, here_m, 0.0, serial);
    return seen.holds_zone(machine_, step.T_world_before, step.command, vouched);
}

void StepQuestions::ask(const grid::MapSnapshot& map) {
    const sim::StepEvent& event = truth_.steps[steps_.size()];
    const gate::Query query = query_of(event, map);
    const gate::Verdict verdict = decide_offline(machine_, query, map);
    const sim::SafetyAnswer answer =
        sim::judge(truth_.scene, machine_, event.T_world_before, event.command);
    const bool seen = answer.safe && is_seen(event, query);
    steps_.push_back({static_cast<int>(steps_.size()) + 1,
                      event.start_s,
                      event.command,
                      answer.safe,
                      answer.clear_cut,
                      seen,
                      joined(names_of(answer)),
                      gate::to_string(verdict.decision),
                      joined(gate::names_of(verdict.reasons))});
}

}  // namespace surefoot::app
