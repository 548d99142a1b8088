// SPDX-License-Identifier: Apache-2.0
#include "studies/lange2016/thesis_policy_steps.hpp"

#include <cmath>

#include "studies/runs/offline_map.hpp"
#include "surefoot/eval/maps/thesis_policy.hpp"
#include "surefoot/sim/safety_oracle/safety_oracle.hpp"

namespace surefoot::app {
bool thesis_allows(const Machine& machine,
                   const grid::GridGeometry& geometry,
                   ImageView<const float> rating,
                   const Pose& T_odom_body,
                   int command) {
    const Movement& movement = machine.movements[static_cast<std::size_t>(command)];
    const double yaw = yaw_rad(T_odom_body);
    const double forward_m = 1e-4 * movement.forward_tenth_mm;
    const double left_m = 1e-4 * movement.left_tenth_mm;
    const traversability::FootprintPose target{
        T_odom_body.translation_m.x() + std::cos(yaw) * forward_m - std::sin(yaw) * left_m,
        T_odom_body.translation_m.y() + std::sin(yaw) * forward_m + std::cos(yaw) * left_m,
        yaw + std::atan2(movement.sin_turn, movement.cos_turn)};
    return eval::thesis_policy({}, target, geometry, rating).allowed;
}

void PolicySteps::ask(const pipeline::Pipeline& pipeline, const grid::MapSnapshot& map) {
    const int command = truth_.steps[steps_.steps().size()].command;
    steps_.ask(map);
    const SuiteStep& step = steps_.steps().back();
    const bool thesis = thesis_allows(machine_,
                                      pipeline.map().geometry(),
                                      pipeline.rating().traversability.view(),
                                      pipeline.T_odom_body(),
                                      command);
    answers_.push_back({step.safe, step.clear_cut, true, step.allowed(), thesis});
}

void PolicySteps::ask_all(std::size_t frame,
                          const pipeline::Pipeline& pipeline,
                          const grid::MapSnapshot& map) {
    const Pose& T_world_body = truth_.trajectory[frame].T_world_body;
    for (int command = 1; command < Machine::kMovementCodes; ++command) {
        if (!machine_.movements[static_cast<std::size_t>(command)].configured) continue;
        const sim::SafetyAnswer answer = sim::judge(truth_.scene, machine_, T_world_body, command);
        const gate::Query query = gate::query_at_body(static_cast<std::uint8_t>(command), map);
        const bool gate = decide_offline(machine_, query, map).decision == gate::Decision::ok;
        const bool thesis = thesis_allows(machine_,
                                          pipeline.map().geometry(),
                                          pipeline.rating().traversability.view(),
                                          pipeline.T_odom_body(),
                                          command);
        answers_.push_back({answer.safe, answer.clear_cut, false, gate, thesis});
    }
}

void PolicySteps::add_to(bool gate, ThesisFigures& figures) const {
    int safe = 0;
    int safe_allowed = 0;
    int dangers = 0;
    int dangers_allowed = 0;
    int steps = 0;
    for (const Answer& answer : answers_) {
        const bool allowed = gate ? answer.gate : answer.thesis;
        steps += answer.of_way ? 1 : 0;
        if (!answer.clear_cut) continue;
        if (!answer.safe) {
            ++dangers;
            dangers_allowed += allowed ? 1 : 0;
        } else if (answer.of_way) {
            ++safe;
            safe_allowed += allowed ? 1 : 0;
        }
    }
    figures.set("steps", steps);
    figures.set("steps_allowed",
                safe > 0 ? static_cast<double>(safe_allowed) / safe : std::nan(""));
    figures.set("dangers", dangers);
    figures.set("dangers_allowed", dangers_allowed);
}

}  // namespace surefoot::app
