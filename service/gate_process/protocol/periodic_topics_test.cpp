// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/protocol/periodic_topics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/json_text.hpp"
#include "service/gate_process/protocol/topic_json.hpp"
#include "service/gate_process/wire_testing.hpp"

namespace surefoot::gate_process {
namespace {

using testing::kMs;
using testing::ScriptedGate;

std::ptrdiff_t count(const std::vector<TopicMessage>& messages, Topic topic) {
    return std::count_if(
        messages.begin(), messages.end(), [&](const auto& m) { return m.topic == topic; });
}

TEST(PeriodicTopics, HealthAtTwoHertzAtLeastAndDiagnosticsAtOne) {
    ScriptedGate gate;
    PeriodicTopics topics;
    std::ptrdiff_t health = 0;
    std::ptrdiff_t diagnostics = 0;
    for (std::int64_t now_ns = 0; now_ns < 10'000 * kMs; now_ns += 5 * kMs) {
        const auto messages = topics.due(gate, now_ns);
        health += count(messages, Topic::health);
        diagnostics += count(messages, Topic::diagnostics);
    }
    EXPECT_EQ(health, 25);
    EXPECT_EQ(diagnostics, 10);
}

TEST(PeriodicTopics, AChangeOfStateIsSaidAtOnce) {
    ScriptedGate gate;
    PeriodicTopics topics;
    (void)topics.due(gate, 0);
    EXPECT_EQ(topics.due(gate, 20 * kMs).size(), 0U);
    gate.report_.health.state = gate::GateState::fault;
    gate.report_.why = gate::Reason::pose_lost;
    const auto messages = topics.due(gate, 25 * kMs);
    ASSERT_EQ(messages.size(), 1U);
    const Json health = Json::parse(*messages[0].body);
    EXPECT_EQ(health["state"], "FAULT");
    EXPECT_EQ(health["why"], "POSE_LOST");
    EXPECT_EQ(topics.due(gate, 30 * kMs).size(), 0U);
}

TEST(PeriodicTopics, EachOfTheFourPartsOfAStateCounts) {
    using Change = void (*)(GateReport&);
    for (const Change change :
         {Change([](GateReport& r) { r.health.state = gate::GateState::degraded; }),
          Change([](GateReport& r) { r.health.faults.add(gate::Reason::blind); }),
          Change([](GateReport& r) { r.why = gate::Reason::warmup; }),
          Change([](GateReport& r) { r.attestation = true; })}) {
        ScriptedGate gate;
        PeriodicTopics topics;
        (void)topics.due(gate, 0);
        change(gate.report_);
        EXPECT_EQ(topics.due(gate, 20 * kMs).size(), 1U);
    }
}

TEST(PeriodicTopics, HealthHasTheAttestedArea) {
    ScriptedGate gate;
    EXPECT_TRUE(health_object(gate.report_)["attested"].is_null());
    gate.report_.attestation = true;
    gate.report_.attested = {true, 12'340, -5'000, 6'000, -9'900};
    const Json area = health_object(gate.report_)["attested"];
    EXPECT_NEAR(area["x_m"].get<double>(), 1.234, 1e-9);
    EXPECT_NEAR(area["y_m"].get<double>(), -0.5, 1e-9);
    EXPECT_NEAR(area["z_m"].get<double>(), -0.99, 1e-9);
    EXPECT_NEAR(area["radius_m"].get<double>(), 0.6, 1e-9);
}

TEST(PeriodicTopics, ANewAttestationOverAnOldOneIsSaidAtOnce) {
    ScriptedGate gate;
    PeriodicTopics topics;
    gate.report_.attestation = true;
    gate.report_.attested = {true, 0, 0, 6'000, 0};
    (void)topics.due(gate, 0);
    gate.report_.attested.radius_tenth_mm = 8'000;
    EXPECT_EQ(topics.due(gate, 20 * kMs).size(), 1U);
}

TEST(PeriodicTopics, AFlickeringStateIsNoFlood) {
    ScriptedGate gate;
    PeriodicTopics topics;
    std::size_t messages = 0;
    for (std::int64_t now_ns = 0; now_ns < 1000 * kMs; now_ns += kMs) {
        gate.report_.attestation = !gate.report_.attestation;
        messages += topics.due(gate, now_ns).size();
    }
    EXPECT_LE(messages, 51U);
}

TEST(PeriodicTopics, DiagnosticsSayLevelAndValues) {
    ScriptedGate gate;
    gate.report_.frame_age_ns = -1;
    PeriodicTopics topics;
    const auto level_in = [&](gate::GateState state, std::int64_t now_ns) {
        gate.report_.health.state = state;
        for (const auto& message : topics.due(gate, now_ns)) {
            if (message.topic == Topic::diagnostics) return Json::parse(*message.body);
        }
        return Json();
    };
    const Json json = level_in(gate::GateState::ready, 2'500 * kMs);
    const Json& status = json["status"][0];
    EXPECT_EQ(json["header"]["stamp"]["secs"], 2);
    EXPECT_EQ(json["header"]["stamp"]["nsecs"], 500'000'000);
    EXPECT_EQ(status["level"], 0);
    EXPECT_EQ(status["message"], "READY");
    for (const Json& value : status["values"]) {
        EXPECT_TRUE(value["value"].is_string()) << value;
        if (value["key"] == "frame_age_ms") {
            EXPECT_EQ(value["value"], "null");
        }
    }
    EXPECT_EQ(level_in(gate::GateState::warmup, 4'000 * kMs)["status"][0]["level"], 1);
    EXPECT_EQ(level_in(gate::GateState::fault, 6'000 * kMs)["status"][0]["level"], 2);
    EXPECT_EQ(level_in(gate::GateState::stopping, 8'000 * kMs)["status"][0]["level"], 2);
}

}  // namespace
}  // namespace surefoot::gate_process
