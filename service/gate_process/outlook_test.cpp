// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/outlook.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numeric>

#include "service/gate_process/protocol/json_text.hpp"
#include "service/gate_process/wire_testing.hpp"

namespace surefoot::gate_process {
namespace {

using testing::kBackward;
using testing::kForward;
using testing::kMs;
using testing::ScriptedGate;

constexpr OutlookDemand kListening{.subscribed = true, .question_waits = false};
constexpr OutlookDemand kBusy{.subscribed = true, .question_waits = true};

/// A gate, the rounds, and the time of the service: one call every 5 ms.
struct Outlook {
    std::optional<Json> call(const OutlookDemand& demand = kListening) {
        now_ns += 5 * kMs;
        const std::size_t before = gate.looked_at.size();
        const auto message = rounds.next(gate, demand, now_ns);
        EXPECT_LE(gate.looked_at.size(), before + 1) << "one movement a call";
        if (!message) return std::nullopt;
        EXPECT_EQ(message->topic, Topic::outlook);
        return Json::parse(*message->body);
    }
    int messages_in(std::int64_t duration_ns, const OutlookDemand& demand = kListening) {
        int messages = 0;
        for (const std::int64_t end_ns = now_ns + duration_ns; now_ns < end_ns;)
            messages += call(demand) ? 1 : 0;
        return messages;
    }

    ScriptedGate gate;
    OutlookRounds rounds;
    std::int64_t now_ns = 1000 * kMs;
};

TEST(OutlookRounds, OneMovementACallAndAWholeRoundIsPublished) {
    Outlook outlook;
    EXPECT_FALSE(outlook.call());
    EXPECT_FALSE(outlook.call());
    const auto json = outlook.call();
    ASSERT_TRUE(json);
    EXPECT_EQ(outlook.gate.looked_at, (std::vector<std::uint8_t>{kForward, kBackward, 21}));
    EXPECT_EQ((*json)["map_version"], 42);
    EXPECT_EQ((*json)["state"], "READY");
    ASSERT_EQ((*json)["verdicts"].size(), 3U);
    const Json expected = {{"command", 17},
                           {"verdict", "NOT_TRAVERSABLE"},
                           {"primary", "DROP_OFF"},
                           {"text", "drop of 0.17 m, 0.31 m behind the left foot (limit 0.020 m)"}};
    EXPECT_EQ((*json)["verdicts"][1], expected);
    EXPECT_EQ((*json)["verdicts"][0]["verdict"], "OK");
    EXPECT_EQ((*json)["verdicts"][0]["primary"], "NONE");
}

TEST(OutlookRounds, NothingOfItIsAQuestion) {
    Outlook outlook;
    (void)outlook.messages_in(1000 * kMs);
    EXPECT_TRUE(outlook.gate.questions.empty());
    EXPECT_EQ(outlook.gate.report_.asked, 0U);
    EXPECT_EQ(outlook.gate.report_.allowed, 0U);
    EXPECT_TRUE(outlook.gate.last_sequence.empty());
}

TEST(OutlookRounds, FourTimesASecondAtMostAndTwiceAtLeastForAllCodes) {
    Outlook outlook;
    EXPECT_EQ(outlook.messages_in(10'000 * kMs), 40);
    outlook.gate.movement_codes.resize(Machine::kMovementCodes - 1);
    std::iota(outlook.gate.movement_codes.begin(), outlook.gate.movement_codes.end(), 1);
    (void)outlook.messages_in(1000 * kMs);
    EXPECT_GE(outlook.messages_in(10'000 * kMs), 20);
    outlook.gate.movement_codes.clear();
    (void)outlook.messages_in(1000 * kMs);
    EXPECT_EQ(outlook.messages_in(10'000 * kMs), 40) << "a machine without movements says so";
}

TEST(OutlookRounds, WithoutASubscriberTheGateIsNotAsked) {
    Outlook outlook;
    EXPECT_EQ(outlook.messages_in(1000 * kMs, {}), 0);
    EXPECT_TRUE(outlook.gate.looked_at.empty());
    // A client that returns gets nothing of the abandoned round.
    (void)outlook.messages_in(1000 * kMs);
    while (outlook.gate.looked_at.size() % 3 != 1) (void)outlook.call();
    (void)outlook.messages_in(1000 * kMs, {});
    outlook.gate.looked_at.clear();
    while (!outlook.call()) {
    }
    EXPECT_EQ(outlook.gate.looked_at, outlook.gate.movement_codes);
}

TEST(OutlookRounds, AQuestionBetweenGoesFirstAndTheRoundGoesOn) {
    Outlook outlook;
    EXPECT_FALSE(outlook.call());
    EXPECT_FALSE(outlook.call(kBusy));
    EXPECT_FALSE(outlook.call(kBusy));
    EXPECT_EQ(outlook.gate.looked_at.size(), 1U);
    EXPECT_TRUE(outlook.gate.ask_step({1, 1, kForward}, outlook.now_ns)
                    .verdict.allows_step(outlook.now_ns));
    EXPECT_FALSE(outlook.call());
    EXPECT_TRUE(outlook.call());
    EXPECT_EQ(outlook.gate.looked_at, outlook.gate.movement_codes);
}

TEST(OutlookRounds, AFloodOfOneDoesNotTakeThePictureFromTheOthers) {
    Outlook outlook;
    (void)outlook.messages_in(10'000 * kMs, kBusy);
    EXPECT_EQ(outlook.gate.looked_at.size(), 120U) << "a movement every fifth call";
}

TEST(OutlookRounds, NoMessageMixesTwoStates) {
    Outlook outlook;
    EXPECT_FALSE(outlook.call());
    EXPECT_FALSE(outlook.call());
    outlook.gate.report_.health.state = gate::GateState::fault;
    outlook.gate.report_.why = gate::Reason::pose_lost;
    EXPECT_FALSE(outlook.call()) << "the third of the old round";
    EXPECT_FALSE(outlook.call());
    const auto json = outlook.call();
    ASSERT_TRUE(json);
    EXPECT_EQ((*json)["state"], "FAULT");
    for (const Json& verdict : (*json)["verdicts"]) EXPECT_EQ(verdict["verdict"], "ERROR");
}

}  // namespace
}  // namespace surefoot::gate_process
