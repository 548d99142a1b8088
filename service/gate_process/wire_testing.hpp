// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "service/gate_process/step_gate.hpp"

/// Shared by the tests of the service: a gate that follows a script instead of a map.
namespace surefoot::gate_process::testing {

inline constexpr std::int64_t kMs = 1'000'000;
inline constexpr std::int64_t kNowNs = 5'000'000'000;
inline constexpr std::uint8_t kForward = 9;
inline constexpr std::uint8_t kBackward = 17;

/// Tokens of tests/conformance/rosbridge.
inline Access three_tokens(Role guest = Role::rider) {
    Access access;
    access.observer = "observer-token-of-tests";
    access.rider = "rider-token-of-tests";
    access.operator_ = "operator-token-of-tests";
    access.guest = guest;
    return access;
}

/// The rules are in tests/conformance/rosbridge/README.md: command 9 is OK, 17 is a drop, 21 is
/// unknown ground, other codes are unknown commands. A sequence that does not increase is ERROR /
/// SEQ. Goals: ahead of x = 0 OK, beside it a drop, behind it ERROR.
class ScriptedGate : public StepGate {
  public:
    [[nodiscard]] Answer ask_step(const StepQuestion& question, std::int64_t now_ns) override {
        questions.push_back(question);
        looks_before.push_back(looked_at.size());
        Answer answer;
        gate::Verdict& verdict = answer.verdict;
        verdict.command = question.command;
        verdict.connection = question.connection;
        verdict.sequence = question.sequence;
        verdict.map_version = 42;
        verdict.config_hash = 0xfedcba9876543210U;
        verdict.decided_ns = now_ns;
        std::uint64_t& last = last_sequence[question.connection];
        const bool grows = question.sequence > last;
        if (grows) last = question.sequence;
        if (!grows) {
            deny(answer, gate::Reason::seq, "the query is out of sequence");
        } else {
            answer_by_script(answer, question.command);
        }
        verdict.valid_until_ns = now_ns + (verdict.decision == gate::Decision::ok ? life_ns : 0);
        if (change_answer) change_answer(verdict);
        if (verdict.allows_step(now_ns)) ++report_.allowed;
        ++report_.asked;
        return answer;
    }

    [[nodiscard]] Answer ask_goal(const GoalQuestion& question, std::int64_t now_ns) override {
        goals.push_back(question);
        Answer answer;
        answer.verdict.connection = question.connection;
        answer.verdict.decided_ns = answer.verdict.valid_until_ns = now_ns;
        if (question.frame_id != "odom") {
            deny(answer, gate::Reason::frame_id, "the query is in a frame that is not known");
        } else if (question.x_m > 0.0) {
            allow(answer);
        } else if (question.x_m == 0.0) {
            deny(answer, gate::Reason::drop_off, "edge of a drop");
        } else {
            deny(answer, gate::Reason::map_stale, "the map is too old");
        }
        return answer;
    }

    [[nodiscard]] std::span<const std::uint8_t> movements() const noexcept override {
        return movement_codes;
    }
    [[nodiscard]] Prospect prospect_of(std::uint8_t command,
                                       std::int64_t now_ns) const noexcept override {
        looked_at.push_back(command);
        Prospect prospect;
        prospect.verdict = scripted_answer(command).verdict;
        prospect.verdict.command = command;
        prospect.verdict.decided_ns = prospect.verdict.valid_until_ns = now_ns;
        return prospect;
    }
    [[nodiscard]] std::string words_of(const Prospect& prospect) const override {
        return scripted_answer(prospect.verdict.command).text;
    }
    [[nodiscard]] GateReport report(std::int64_t /*now_ns*/) override { return report_; }
    [[nodiscard]] Status rearm(std::uint64_t connection, std::int64_t /*now_ns*/) override {
        rearmed.push_back(connection);
        return {};
    }
    [[nodiscard]] Status attest(std::uint64_t connection,
                                double radius_m,
                                std::int64_t /*now_ns*/) override {
        if (!(radius_m > 0.0 && radius_m <= 0.5))
            return input_error("attest: the radius is not within 0.5 m");
        attested.emplace_back(connection, radius_m);
        return {};
    }
    void forget(std::uint64_t connection) override { forgotten.push_back(connection); }
    void note(const Act& act) override { acts.push_back(act); }

    GateReport report_ = ready_report();
    std::int64_t life_ns = 300 * kMs;
    void (*change_answer)(gate::Verdict&) = nullptr;  ///< replaces the answer by a wrong one

    std::vector<StepQuestion> questions;
    std::vector<GoalQuestion> goals;
    std::vector<std::uint64_t> rearmed;
    std::vector<std::pair<std::uint64_t, double>> attested;
    std::vector<std::uint64_t> forgotten;
    std::vector<Act> acts;
    std::map<std::uint64_t, std::uint64_t> last_sequence;

    std::vector<std::uint8_t> movement_codes{kForward, kBackward, 21};
    mutable std::vector<std::uint8_t> looked_at;  ///< commands of the prospects
    std::vector<std::size_t> looks_before;        ///< number of prospects before each question

  private:
    void answer_by_script(Answer& answer, std::uint8_t command) const {
        if (report_.health.state != gate::GateState::ready)
            return deny(answer, report_.why, "the system is not ready");
        judge(answer, command);
    }
    [[nodiscard]] Answer scripted_answer(std::uint8_t command) const {
        Answer answer;
        answer_by_script(answer, command);
        return answer;
    }
    static GateReport ready_report() {
        GateReport report;
        report.health.state = gate::GateState::ready;
        report.why = gate::Reason::none;
        report.map_version = 42;
        report.frame_age_ns = 50 * kMs;
        report.pose_age_ns = 10 * kMs;
        return report;
    }
    static void allow(Answer& answer) {
        answer.verdict.decision = gate::Decision::ok;
        answer.verdict.reasons = {};
        answer.verdict.primary = gate::Reason::none;
        answer.text = "the way is clear and the ground carries";
    }
    static void deny(Answer& answer, gate::Reason reason, const char* text) {
        answer.verdict.decision =
            is_error(reason) ? gate::Decision::error : gate::Decision::not_traversable;
        answer.verdict.reasons = gate::ReasonSet(reason);
        answer.verdict.primary = reason;
        answer.text = text;
    }
    static void judge(Answer& answer, std::uint8_t command) {
        switch (command) {
            case kForward: return allow(answer);
            case kBackward: {
                deny(answer,
                     gate::Reason::drop_off,
                     "drop of 0.17 m, 0.31 m behind the left foot (limit 0.020 m)");
                gate::Evidence& e = answer.verdict.evidence;
                e.has_worst_cell = true;
                e.worst_x_tenth_mm = -4375;
                e.worst_y_tenth_mm = 1125;
                e.foot = gate::Foot::left;
                e.value_tenth_mm = 1700;
                e.limit_tenth_mm = 200;
                return;
            }
            case 21: return deny(answer, gate::Reason::unknown_cells, "ground never seen");
            default:
                return deny(
                    answer, gate::Reason::unknown_command, "the machine has no such movement");
        }
    }
};

}  // namespace surefoot::gate_process::testing
