// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/protocol/periodic_topics.hpp"

#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/topic_json.hpp"

namespace surefoot::gate_process {
namespace {

constexpr std::int64_t kNsPerMs = 1'000'000;
constexpr std::int64_t kHealthNs = 400 * kNsPerMs;
// The shortest pause between two health messages, even if the state changes often.
constexpr std::int64_t kChangedHealthNs = 20 * kNsPerMs;
constexpr std::int64_t kDiagnosticsNs = 1000 * kNsPerMs;

bool same_area(const gate::AttestedArea& a, const gate::AttestedArea& b) {
    return a.active == b.active && a.center_x_tenth_mm == b.center_x_tenth_mm &&
           a.center_y_tenth_mm == b.center_y_tenth_mm && a.radius_tenth_mm == b.radius_tenth_mm &&
           a.height_tenth_mm == b.height_tenth_mm;
}

bool same_state(const GateReport& a, const GateReport& b) {
    return a.health.state == b.health.state && a.health.faults == b.health.faults &&
           a.why == b.why && a.attestation == b.attestation && same_area(a.attested, b.attested);
}

}  // namespace

bool PeriodicTopics::health_is_due(const GateReport& report, std::int64_t now_ns) {
    if (!last_) return true;
    const std::int64_t since_ns = now_ns - last_health_ns_;
    return since_ns >= (same_state(report, *last_) ? kHealthNs : kChangedHealthNs);
}

bool PeriodicTopics::diagnostics_are_due(std::int64_t now_ns) {
    return !last_diagnostics_ns_ || now_ns - *last_diagnostics_ns_ >= kDiagnosticsNs;
}

std::vector<TopicMessage> PeriodicTopics::due(StepGate& gate, std::int64_t now_ns) {
    std::vector<TopicMessage> messages;
    const GateReport report = gate.report(now_ns);
    const auto publish = [&](Topic topic, const Json& body) {
        messages.push_back({topic, std::make_shared<const std::string>(dump(body))});
    };
    if (health_is_due(report, now_ns)) {
        publish(Topic::health, health_object(report));
        last_ = report;
        last_health_ns_ = now_ns;
    }
    if (diagnostics_are_due(now_ns)) {
        publish(Topic::diagnostics, diagnostics_object(report, now_ns));
        last_diagnostics_ns_ = now_ns;
    }
    return messages;
}

}  // namespace surefoot::gate_process
