// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/motion/commanded_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "surefoot/core/rng.hpp"

namespace surefoot::sim {

CommandedMotion::CommandedMotion(GroundHeight ground_z_m,
                                 const RexGaitConfig& gait,
                                 std::uint64_t seed)
    : ground_z_m_(std::move(ground_z_m)), gait_(gait), seed_(seed), movements_(rex_movements({})) {}

Result<std::shared_ptr<CommandedMotion>> CommandedMotion::make(const RexStand& start,
                                                               GroundHeight ground_z_m,
                                                               const RexGaitConfig& gait,
                                                               std::uint64_t seed) {
    std::shared_ptr<CommandedMotion> made(new CommandedMotion(std::move(ground_z_m), gait, seed));
    RexPlan still;
    still.start = start;
    auto motion = made->walk(still);
    if (!motion) return motion.error();
    made->pieces_.push_back({0.0, std::move(motion).value()});
    made->stand_ = start;
    return made;
}

Result<RexMotion> CommandedMotion::walk(const RexPlan& plan) {
    auto motion = RexMotion::make(plan, gait_, ground_z_m_, mix_seed(seed_, walked_));
    if (motion) ++walked_;
    return motion;
}

const CommandedMotion::Piece& CommandedMotion::piece_at(double time_s) const {
    const auto next = std::upper_bound(
        pieces_.begin() + 1, pieces_.end(), time_s, [](double time, const Piece& piece) {
            return time < piece.start_s;
        });
    return *(next - 1);
}

MotionState CommandedMotion::at(double time_s) const {
    const std::lock_guard lock(mutex_);
    const Piece& piece = piece_at(time_s);
    return piece.motion.at(time_s - piece.start_s);
}

std::optional<RexJoints> CommandedMotion::rex_joints(double time_s) const {
    const std::lock_guard lock(mutex_);
    const Piece& piece = piece_at(time_s);
    return piece.motion.rex_joints(time_s - piece.start_s);
}

double CommandedMotion::duration_s() const {
    const std::lock_guard lock(mutex_);
    return free_s_;
}

std::vector<StepEvent> CommandedMotion::steps() const {
    const std::lock_guard lock(mutex_);
    return steps_;
}

void CommandedMotion::forget_before(double time_s) {
    const std::lock_guard lock(mutex_);
    const auto begins_later = [](double time, const auto& part) { return time < part.start_s; };
    const auto now = std::upper_bound(pieces_.begin() + 1, pieces_.end(), time_s, begins_later) - 1;
    pieces_.erase(pieces_.begin(), now);
    std::erase_if(steps_, [&](const StepEvent& step) { return step.end_s < time_s; });
}

Result<StepEvent> CommandedMotion::step(int command, double time_s) {
    const std::lock_guard lock(mutex_);
    const auto movement = std::find_if(
        movements_.begin(), movements_.end(), [&](const auto& m) { return m.command == command; });
    if (movement == movements_.end())
        return usage_error(fmt::format(
            "simulated REX: no movement has the command {}; send a command of machines/rex.yaml",
            command));
    if (time_s < free_s_)
        return usage_error(
            fmt::format("simulated REX: a step cannot begin at {:.2f} s, because the last step "
                        "ends at {:.2f} s; begin it later",
                        time_s,
                        free_s_));
    RexPlan plan;
    plan.start = stand_;
    plan.steps.push_back({0.0, *movement, stand_, moved(stand_, *movement, 1.0)});
    auto motion = walk(plan);
    if (!motion) return motion.error();
    const RexMotion::Span& span = motion->steps().front();
    const StepEvent event{time_s + span.start_s,
                          time_s + span.end_s,
                          command,
                          span.T_world_before,
                          span.T_world_after};
    stand_ = plan.steps.front().after;
    free_s_ = time_s + motion->duration_s();
    pieces_.push_back({time_s, std::move(motion).value()});
    steps_.push_back(event);
    return event;
}

}  // namespace surefoot::sim
