// SPDX-License-Identifier: Apache-2.0
// Any messages to one session. A reply or topic says OK only if the gate said OK in the same call,
// for this connection and sequence. The first byte chooses the behaviour of the gate, the second
// one the time between messages; each further line is a message.
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "fuzz/must.hpp"
#include "service/gate_process/protocol/rosbridge_session.hpp"
#include "service/gate_process/wire_testing.hpp"

namespace {

using namespace surefoot;
using gate_process::Json;

constexpr std::uint64_t kConnection = 77;

/// Records the query of the current call and whether it was allowed.
struct Witness : gate_process::testing::ScriptedGate {
    [[nodiscard]] gate_process::Answer ask_step(const gate_process::StepQuestion& question,
                                                std::int64_t now_ns) override {
        must(!asked);  // one query per message
        asked = question;
        gate_process::Answer answer = ScriptedGate::ask_step(question, now_ns);
        allowed = question.connection == kConnection && answer.verdict.allows_step(now_ns) &&
                  answer.verdict.connection == kConnection &&
                  answer.verdict.sequence == question.sequence &&
                  answer.verdict.command == question.command;
        return answer;
    }
    std::optional<gate_process::StepQuestion> asked;
    bool allowed = false;
};

void set_mood(Witness& gate, std::uint8_t mood) {
    using Change = void (*)(gate::Verdict&);
    constexpr Change kChanges[] = {nullptr,
                                   nullptr,
                                   nullptr,
                                   [](gate::Verdict& v) { ++v.connection; },
                                   [](gate::Verdict& v) { v.sequence = 1; },
                                   [](gate::Verdict& v) { v.command = 9; },
                                   [](gate::Verdict& v) { v.valid_until_ns = v.decided_ns; },
                                   [](gate::Verdict& v) { v.reasons.add(gate::Reason::blind); }};
    gate.change_answer = kChanges[mood % 8];
    if ((mood & 8U) != 0U) gate.report_.health.state = gate::GateState::fault;
}

bool is(const Json& values, const char* key, const Json& value) {
    return values.is_object() && values.contains(key) && values[key] == value;
}

/// Whether a client may read this as permission to step, in any of the documented forms.
bool says_ok(const Json& values) {
    return is(values, "resultCode", 0) || is(values, "result_code", 0) ||
           is(values, "verdict", "OK");
}

void check_verdict(const Witness& gate, const Json& values) {
    if (!says_ok(values)) return;
    must(gate.allowed && gate.asked.has_value());
    if (!values.contains("verdict")) return;
    must(is(values, "connection", kConnection) && is(values, "sequence", gate.asked->sequence) &&
         is(values, "result_code", 0));
}

void check_reply(const Witness& gate, const std::string& text) {
    const Json reply = Json::parse(text);  // throws on invalid JSON: a finding
    if (!is(reply, "op", "service_response")) return;
    check_verdict(gate, reply["values"]);
    const std::string service = reply["service"];
    must(!service.ends_with("step_forward") || reply["result"] != true || gate.allowed);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 2) return 0;
    Witness gate;
    set_mood(gate, data[0]);
    gate_process::SessionLimits limits;
    limits.messages = {.per_s = 100, .burst = 8};
    limits.refusals = {.per_s = 100, .burst = 8};
    const gate_process::Access access = gate_process::testing::three_tokens();
    // Any role. A message that the role does not permit must not reach the gate.
    const auto role = static_cast<gate_process::Role>((data[0] >> 4U) % 4U);
    gate_process::RosbridgeSession session(kConnection, gate, limits, {role, &access});
    std::string_view rest(reinterpret_cast<const char*>(data) + 2, size - 2);
    std::int64_t now_ns = 1'000'000'000;
    for (bool dropped = false; !rest.empty() && !dropped;) {
        const std::string_view line = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(rest.size(), line.size() + 1));
        gate.asked.reset();
        gate.allowed = false;
        const gate_process::Reaction reaction = session.on_message(line, now_ns);
        for (const auto& reply : reaction.replies) check_reply(gate, reply);
        for (const auto& message : reaction.published) {
            if (message.topic == gate_process::Topic::verdict)
                check_verdict(gate, Json::parse(*message.body));
            for (const auto& text : session.on_topic(message, now_ns)) (void)Json::parse(text);
        }
        now_ns += data[1] * gate_process::testing::kMs;
        for (const auto& text : session.due(now_ns)) (void)Json::parse(text);
        dropped = reaction.drop;
    }
    return 0;
}
