// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/protocol/rosbridge_session.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "service/gate_process/wire_testing.hpp"

namespace surefoot::gate_process {
namespace {

using testing::kMs;
using testing::kNowNs;
using testing::ScriptedGate;

const SessionRights kOperator{Role::operator_, nullptr};
const Access kAccess = testing::three_tokens();

const char* const kAhead =
    R"({"op":"call_service","id":"q","service":"/surefoot/step","args":[9]})";
const char* const kAheadPlain = R"({"op":"call_service","id":"q","service":"/step","args":[9]})";

/// True if `actual` contains everything of `expected` with equal values.
bool holds(const Json& actual, const Json& expected) {
    if (!expected.is_object()) return actual == expected;
    if (!actual.is_object()) return false;
    for (const auto& [key, value] : expected.items()) {
        if (!actual.contains(key) || !holds(actual[key], value)) return false;
    }
    return true;
}

Json vectors() {
    std::ifstream file(std::string(SUREFOOT_SOURCE_DIR) +
                       "/tests/conformance/rosbridge/vectors.json");
    std::stringstream text;
    text << file.rdbuf();
    return Json::parse(text.str());
}

std::string topic_name(Topic topic) {
    for (const auto& entry : kTopics) {
        if (entry.topic == topic) return std::string(entry.name);
    }
    return "?";
}

Json values_of(const Reaction& reaction) {
    return reaction.replies.empty() ? Json() : Json::parse(reaction.replies.front())["values"];
}

TEST(RosbridgeSession, AnswersEveryConversationAsItIsWrittenDown) {
    const Json all = vectors();
    ASSERT_GT(all.size(), 40U);
    std::uint64_t connection = 1;
    for (const Json& vector : all) {
        ScriptedGate gate;
        const Role role = role_named(vector.value("role", "rider")).value();
        RosbridgeSession session(connection++, gate, {}, {role, &kAccess});
        std::vector<std::string> replies;
        Json published = Json::array();
        for (const Json& text : vector["send"]) {
            const Reaction reaction = session.on_message(text.get<std::string>(), kNowNs);
            replies.insert(replies.end(), reaction.replies.begin(), reaction.replies.end());
            for (const auto& message : reaction.published)
                published.push_back(topic_name(message.topic));
            EXPECT_FALSE(reaction.drop);
        }
        ASSERT_EQ(replies.size(), vector["replies"].size()) << vector["name"];
        for (std::size_t i = 0; i < replies.size(); ++i) {
            EXPECT_TRUE(holds(Json::parse(replies[i]), vector["replies"][i]))
                << vector["name"] << "\n got " << replies[i] << "\n not " << vector["replies"][i];
        }
        EXPECT_EQ(published, vector["published"]) << vector["name"];
    }
}

TEST(RosbridgeSession, AsksTheGateOnceForEachReadableQuestion) {
    ScriptedGate gate;
    RosbridgeSession session(7, gate, {}, kOperator);
    (void)session.on_message(kAheadPlain, kNowNs);
    (void)session.on_message(R"({"op":"call_service","service":"/step","args":[9.5]})", kNowNs);
    (void)session.on_message(R"({"op":"call_service","service":"/step_forward"})", kNowNs);
    ASSERT_EQ(gate.questions.size(), 2U);
    EXPECT_EQ(gate.questions[0].connection, 7U);
    EXPECT_EQ(gate.questions[0].sequence, 1U);
    EXPECT_EQ(gate.questions[1].sequence, 2U);
    EXPECT_EQ(gate.questions[1].command, testing::kForward);
}

TEST(RosbridgeSession, StepForwardFailsUnlessItIsAllowed) {
    ScriptedGate gate;
    gate.report_.health.state = gate::GateState::fault;
    gate.report_.why = gate::Reason::pose_lost;
    RosbridgeSession session(1, gate, {}, kOperator);
    const Reaction reaction =
        session.on_message(R"({"op":"call_service","service":"/step_forward"})", kNowNs);
    const Json response = Json::parse(reaction.replies.at(0));
    EXPECT_EQ(response["result"], false);
    EXPECT_EQ(response["values"]["resultCode"], -1);
}

TEST(RosbridgeSession, AnOkToAnotherQuestionIsAnError) {
    using Change = void (*)(gate::Verdict&);
    for (const Change change : {Change([](gate::Verdict& v) { ++v.connection; }),
                                Change([](gate::Verdict& v) { --v.sequence; }),
                                Change([](gate::Verdict& v) { v.command = testing::kBackward; })}) {
        ScriptedGate gate;
        gate.change_answer = change;
        RosbridgeSession session(1, gate, {}, kOperator);
        const Reaction reaction = session.on_message(kAhead, kNowNs);
        EXPECT_EQ(values_of(reaction)["result_code"], -1);
        EXPECT_EQ(values_of(reaction)["primary"], "INTERNAL");
        EXPECT_EQ(values_of(reaction)["connection"], 1);
        EXPECT_EQ(values_of(reaction)["sequence"], 1);
        EXPECT_EQ(Json::parse(*reaction.published.at(0).body)["verdict"], "ERROR");
    }
}

TEST(RosbridgeSession, AnOkThatIsNotValidNowIsAnError) {
    using Change = void (*)(gate::Verdict&);
    for (const Change change :
         {Change([](gate::Verdict& v) { v.valid_until_ns = v.decided_ns; }),
          Change([](gate::Verdict& v) { ++v.decided_ns; }),
          Change([](gate::Verdict& v) { v.reasons.add(gate::Reason::drop_off); })}) {
        ScriptedGate gate;
        gate.change_answer = change;
        RosbridgeSession session(1, gate, {}, kOperator);
        EXPECT_EQ(values_of(session.on_message(kAhead, kNowNs))["primary"], "EXPIRED");
        EXPECT_EQ(values_of(session.on_message(kAheadPlain, kNowNs))["resultCode"], -1);
    }
}

TEST(RosbridgeSession, TooManyQuestionsAreOverload) {
    SessionLimits limits;
    limits.messages = {.per_s = 10, .burst = 3};
    ScriptedGate gate;
    RosbridgeSession session(1, gate, limits, kOperator);
    for (int i = 0; i < 3; ++i)
        EXPECT_EQ(values_of(session.on_message(kAhead, kNowNs))["verdict"], "OK");
    const Reaction refused = session.on_message(kAhead, kNowNs);
    EXPECT_EQ(values_of(refused)["primary"], "OVERLOAD");
    EXPECT_EQ(values_of(refused)["result_code"], -1);
    EXPECT_TRUE(refused.published.empty());
    EXPECT_EQ(gate.questions.size(), 3U);
    EXPECT_EQ(values_of(session.on_message(kAhead, kNowNs + 99 * kMs))["primary"], "OVERLOAD");
    EXPECT_EQ(values_of(session.on_message(kAhead, kNowNs + 100 * kMs))["verdict"], "OK");
}

TEST(RosbridgeSession, NothingElseIsDoneUnderOverload) {
    SessionLimits limits;
    limits.messages = {.per_s = 1, .burst = 1};
    ScriptedGate gate;
    RosbridgeSession session(1, gate, limits, kOperator);
    (void)session.on_message(R"({"op":"status"})", kNowNs);
    for (const char* text : {R"({"op":"call_service","id":"q","service":"/surefoot/rearm"})",
                             R"({"op":"call_service","id":"q","service":"/surefoot/attest",)"
                             R"("args":[0.4]})",
                             R"({"op":"subscribe","topic":"/surefoot/verdict"})",
                             R"({"op":"publish","topic":"/move_base_simple/goal","msg":{}})"}) {
        const Reaction reaction = session.on_message(text, kNowNs);
        ASSERT_EQ(reaction.replies.size(), 1U) << text;
        EXPECT_NE(reaction.replies[0].find("too many messages"), std::string::npos) << text;
        EXPECT_TRUE(reaction.published.empty());
    }
    EXPECT_TRUE(gate.rearmed.empty());
    EXPECT_TRUE(gate.attested.empty());
    EXPECT_TRUE(
        session.on_topic({Topic::verdict, std::make_shared<std::string>("1")}, kNowNs).empty());
}

TEST(RosbridgeSession, AClientThatNeverStopsIsDropped) {
    SessionLimits limits;
    limits.messages = {.per_s = 1, .burst = 1};
    limits.refusals = {.per_s = 1, .burst = 5};
    ScriptedGate gate;
    RosbridgeSession session(1, gate, limits, kOperator);
    for (int i = 0; i < 6; ++i) EXPECT_FALSE(session.on_message(kAhead, kNowNs).drop) << i;
    EXPECT_TRUE(session.on_message(kAhead, kNowNs).drop);
}

TEST(RosbridgeSession, AClientThatOnlyTalksNonsenseIsDropped) {
    SessionLimits limits;
    limits.faults = {.per_s = 1, .burst = 4};
    ScriptedGate gate;
    RosbridgeSession session(1, gate, limits, kOperator);
    for (int i = 0; i < 4; ++i) EXPECT_FALSE(session.on_message("{", kNowNs).drop) << i;
    const Reaction last = session.on_message("{", kNowNs);
    EXPECT_TRUE(last.drop);
    EXPECT_EQ(last.replies.size(), 1U);
    EXPECT_FALSE(session.on_message("{", kNowNs + 1000 * kMs).drop);
}

TEST(RosbridgeSession, TenMegabytesAreRefusedUnread) {
    ScriptedGate gate;
    RosbridgeSession session(1, gate, {}, kOperator);
    const std::string blanks(10'000'000, ' ');
    const Reaction reaction = session.on_message(kAheadPlain + blanks, kNowNs);
    ASSERT_EQ(reaction.replies.size(), 1U);
    EXPECT_NE(reaction.replies[0].find("exceeds the limit of 65536"), std::string::npos);
    EXPECT_TRUE(gate.questions.empty());
}

TEST(RosbridgeSession, AQuestionCutAnywhereIsNoQuestion) {
    const std::string whole = kAheadPlain;
    for (std::size_t size = 0; size < whole.size(); ++size) {
        ScriptedGate gate;
        RosbridgeSession session(1, gate, {}, kOperator);
        const Reaction reaction = session.on_message(whole.substr(0, size), kNowNs);
        EXPECT_EQ(reaction.replies.size(), 1U) << size;
        EXPECT_TRUE(gate.questions.empty()) << size;
        EXPECT_TRUE(reaction.published.empty()) << size;
    }
}

TEST(RosbridgeSession, BytesThatAreNoUtf8AreNoMessage) {
    ScriptedGate gate;
    RosbridgeSession session(1, gate, {}, kOperator);
    for (const char* bad : {"\xff", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe2\x82"}) {
        const std::string text =
            std::string(R"({"op":"call_service","service":"/step","args":[9],"x":")") + bad + "\"}";
        EXPECT_EQ(session.on_message(text, kNowNs).replies.size(), 1U);
    }
    EXPECT_TRUE(gate.questions.empty());
}

TEST(RosbridgeSession, TextOfTheGateThatIsNoUtf8IsNoLostAnswer) {
    struct BrokenWords : ScriptedGate {
        Answer ask_step(const StepQuestion& question, std::int64_t now_ns) override {
            Answer answer = ScriptedGate::ask_step(question, now_ns);
            answer.text = "\xff";
            return answer;
        }
    } gate;
    RosbridgeSession session(1, gate, {}, kOperator);
    EXPECT_EQ(values_of(session.on_message(kAhead, kNowNs))["text"], "\xef\xbf\xbd");
}

TEST(RosbridgeSession, SubscribersHearUnderTheNameTheyUsed) {
    ScriptedGate gate;
    RosbridgeSession asking(1, gate, {}, kOperator);
    RosbridgeSession listening(2, gate, {}, kOperator);
    (void)listening.on_message(R"({"op":"subscribe","topic":"surefoot/verdict"})", kNowNs);
    const Reaction reaction = asking.on_message(kAheadPlain, kNowNs);
    ASSERT_EQ(reaction.published.size(), 1U);
    EXPECT_TRUE(asking.on_topic(reaction.published[0], kNowNs).empty());
    const auto texts = listening.on_topic(reaction.published[0], kNowNs);
    ASSERT_EQ(texts.size(), 1U);
    const Json message = Json::parse(texts[0]);
    EXPECT_EQ(message["op"], "publish");
    EXPECT_EQ(message["topic"], "surefoot/verdict");
    EXPECT_EQ(message["msg"]["verdict"], "OK");
    EXPECT_EQ(message["msg"]["connection"], 1);
    EXPECT_EQ(message["msg"]["decided_ns"], "5000000000");
    EXPECT_EQ(message["msg"]["valid_until_ns"], "5300000000");
}

TEST(RosbridgeSession, ThrottleTimeIsInMilliseconds) {
    ScriptedGate gate;
    RosbridgeSession session(1, gate, {}, kOperator);
    (void)session.on_message(
        R"({"op":"subscribe","topic":"/surefoot/health","throttle_rate":100,"queue_length":1})",
        kNowNs);
    const TopicMessage message{Topic::health, std::make_shared<std::string>("{}")};
    EXPECT_EQ(session.on_topic(message, kNowNs).size(), 1U);
    EXPECT_EQ(session.on_topic(message, kNowNs + 99 * kMs).size(), 0U);
    EXPECT_EQ(session.due(kNowNs + 99 * kMs).size(), 0U);
    EXPECT_EQ(session.due(kNowNs + 100 * kMs).size(), 1U);
    EXPECT_EQ(session.due(kNowNs + 500 * kMs).size(), 0U);
}

TEST(RosbridgeSession, NoMoreSubscriptionsThanTheLimit) {
    SessionLimits limits;
    limits.max_subscriptions = 2;
    ScriptedGate gate;
    RosbridgeSession session(1, gate, limits, kOperator);
    const auto replies = [&](int id) {
        return session
            .on_message(R"({"op":"subscribe","topic":"/surefoot/health","id":")" +
                            std::to_string(id) + "\"}",
                        kNowNs)
            .replies.size();
    };
    EXPECT_EQ(replies(1), 0U);
    EXPECT_EQ(replies(2), 0U);
    EXPECT_EQ(replies(2), 0U);
    EXPECT_EQ(replies(3), 1U);
}

TEST(RosbridgeSession, TheGateForgetsWhoIsGone) {
    ScriptedGate gate;
    { const RosbridgeSession session(5, gate, {}, kOperator); }
    EXPECT_EQ(gate.forgotten, std::vector<std::uint64_t>{5});
}

std::string goal_at(double x_m, const std::string& frame, double yaw_rad) {
    const Json message = {
        {"op", "publish"},
        {"topic", "/move_base_simple/goal"},
        {"msg",
         {{"header", {{"frame_id", frame}}},
          {"pose",
           {{"position", {{"x", x_m}, {"y", 0.5}, {"z", 0}}},
            {"orientation",
             {{"x", 0}, {"y", 0}, {"z", std::sin(yaw_rad / 2)}, {"w", std::cos(yaw_rad / 2)}}}}}}}};
    return message.dump();
}

TEST(RosbridgeSession, AGoalIsAskedWithItsYaw) {
    ScriptedGate gate;
    RosbridgeSession session(3, gate, {}, kOperator);
    (void)session.on_message(goal_at(1.25, "odom", -2.0), kNowNs);
    ASSERT_EQ(gate.goals.size(), 1U);
    EXPECT_EQ(gate.goals[0].connection, 3U);
    EXPECT_EQ(gate.goals[0].frame_id, "odom");
    EXPECT_EQ(gate.goals[0].x_m, 1.25);
    EXPECT_EQ(gate.goals[0].y_m, 0.5);
    EXPECT_NEAR(gate.goals[0].yaw_rad, -2.0, 1e-12);
}

TEST(RosbridgeSession, MarkersDifferInColourAndWords) {
    ScriptedGate gate;
    RosbridgeSession session(1, gate, {}, kOperator);
    const auto markers = [&](double x_m, const std::string& frame) {
        const Reaction reaction = session.on_message(goal_at(x_m, frame, 0.0), kNowNs);
        EXPECT_TRUE(reaction.replies.empty());
        EXPECT_EQ(reaction.published.size(), 2U);
        return std::pair(Json::parse(*reaction.published.at(0).body),
                         Json::parse(*reaction.published.at(1).body));
    };
    const auto [ok, ok_words] = markers(1.0, "odom");
    const auto [no, no_words] = markers(0.0, "odom");
    const auto [unsure, unsure_words] = markers(1.0, "map");
    EXPECT_GT(ok["color"]["g"], 2.0 * ok["color"]["r"].get<double>());
    EXPECT_GT(no["color"]["r"], 2.0 * no["color"]["g"].get<double>());
    EXPECT_GT(unsure["color"]["b"], unsure["color"]["g"]);
    EXPECT_EQ(no["color"]["b"], 0.0);
    EXPECT_EQ(ok["text"], "OK: the way is clear and the ground carries");
    EXPECT_EQ(no["text"], "NOT_TRAVERSABLE: edge of a drop");
    EXPECT_EQ(unsure["text"].get<std::string>().substr(0, 6), "ERROR:");
    EXPECT_EQ(ok["type"], 0);
    EXPECT_EQ(ok_words["type"], 9);
    EXPECT_NE(ok["id"], ok_words["id"]);
    EXPECT_EQ(ok["header"]["frame_id"], "odom");
    EXPECT_EQ(unsure["header"]["frame_id"], "map");
    EXPECT_EQ(ok["pose"]["position"]["x"], 1.0);
    EXPECT_EQ(ok["action"], 0);
}

TEST(RosbridgeSession, MarkersOfAGoalThatCannotBeReadAreTakenAway) {
    ScriptedGate gate;
    RosbridgeSession session(1, gate, {}, kOperator);
    const Reaction reaction = session.on_message(
        R"({"op":"publish","topic":"/move_base_simple/goal","msg":{"pose":null}})", kNowNs);
    ASSERT_EQ(reaction.published.size(), 2U);
    for (const auto& message : reaction.published)
        EXPECT_EQ(Json::parse(*message.body)["action"], 2);
    EXPECT_TRUE(gate.goals.empty());
}

std::string call_of(const std::string& service, const std::string& args) {
    return R"({"op":"call_service","id":"q","service":")" + service + R"(","args":)" + args + "}";
}

TEST(RosbridgeSession, OnlyTheOperatorAttestsAndRearms) {
    for (const Role role : {Role::observer, Role::rider}) {
        ScriptedGate gate;
        RosbridgeSession session(7, gate, {}, {role, &kAccess});
        for (const auto& [text, kind] :
             {std::pair(call_of("/surefoot/attest", "[0.4]"), ActKind::attest),
              std::pair(call_of("/surefoot/rearm", "[]"), ActKind::rearm)}) {
            const Json values = values_of(session.on_message(text, kNowNs));
            EXPECT_EQ(values["success"], false);
            const std::string message = values["message"];
            EXPECT_NE(message.find("role operator"), std::string::npos) << message;
            EXPECT_NE(message.find(to_string(role)), std::string::npos) << message;
            EXPECT_NE(message.find("token file"), std::string::npos) << message;
            ASSERT_FALSE(gate.acts.empty());
            EXPECT_EQ(gate.acts.back().kind, kind);
            EXPECT_EQ(gate.acts.back().outcome, ActOutcome::no_right);
            EXPECT_EQ(gate.acts.back().role, role);
            EXPECT_EQ(gate.acts.back().connection, 7U);
        }
        EXPECT_TRUE(gate.attested.empty());
        EXPECT_TRUE(gate.rearmed.empty());
    }
}

TEST(RosbridgeSession, AnObserverAsksNothingAndReadsEverything) {
    ScriptedGate gate;
    RosbridgeSession session(7, gate, {}, {Role::observer, &kAccess});
    for (const std::string& text :
         {std::string(kAhead), std::string(kAheadPlain), call_of("/step_forward", "[]")}) {
        const Reaction reaction = session.on_message(text, kNowNs);
        const Json response = Json::parse(reaction.replies.at(0));
        EXPECT_EQ(response["result"], false);
        EXPECT_TRUE(response["values"].is_string()) << response;
        EXPECT_TRUE(reaction.published.empty());
    }
    const Reaction goal = session.on_message(goal_at(1.0, "odom", 0.0), kNowNs);
    EXPECT_EQ(Json::parse(goal.replies.at(0))["op"], "status");
    EXPECT_TRUE(goal.published.empty());
    EXPECT_TRUE(gate.questions.empty());
    EXPECT_TRUE(gate.goals.empty());
    EXPECT_EQ(gate.acts.size(), 4U);
    EXPECT_EQ(values_of(session.on_message(call_of("/surefoot/health", "[]"), kNowNs))["state"],
              "READY");
    EXPECT_TRUE(session.on_message(R"({"op":"subscribe","topic":"/surefoot/verdict"})", kNowNs)
                    .replies.empty());
}

TEST(RosbridgeSession, AClientWithoutAnyRoleGetsNoAnswerAboutSteps) {
    ScriptedGate gate;
    RosbridgeSession session(7, gate, {}, {});
    EXPECT_EQ(Json::parse(session.on_message(kAhead, kNowNs).replies.at(0))["result"], false);
    EXPECT_TRUE(gate.questions.empty());
}

TEST(RosbridgeSession, AnActOfTheOperatorIsNotedWithItsOutcome) {
    ScriptedGate gate;
    RosbridgeSession session(7, gate, {}, kOperator);
    (void)session.on_message(call_of("/surefoot/attest", "[0.4]"), kNowNs);
    (void)session.on_message(call_of("/surefoot/attest", "[4]"), kNowNs + 1);
    (void)session.on_message(call_of("/surefoot/rearm", "[]"), kNowNs + 2);
    ASSERT_EQ(gate.acts.size(), 3U);
    EXPECT_EQ(gate.acts[0].outcome, ActOutcome::done);
    EXPECT_EQ(gate.acts[0].radius_tenth_mm, 4000);
    EXPECT_EQ(gate.acts[0].role, Role::operator_);
    EXPECT_EQ(gate.acts[1].outcome, ActOutcome::failed);
    EXPECT_EQ(gate.acts[1].radius_tenth_mm, 40000);
    EXPECT_FALSE(gate.acts[1].text.empty());
    EXPECT_EQ(gate.acts[2].kind, ActKind::rearm);
    EXPECT_EQ(gate.acts[2].time_ns, kNowNs + 2);
}

TEST(RosbridgeSession, ATokenChangesTheRoleOfARunningConnection) {
    for (const std::string& auth :
         {R"({"op":"auth","token":")" + kAccess.operator_ + "\"}",
          R"({"op":"auth","mac":")" + kAccess.operator_ + R"(","client":"","t":0})",
          call_of("/surefoot/authenticate", R"({"token":")" + kAccess.operator_ + "\"}")}) {
        ScriptedGate gate;
        RosbridgeSession session(7, gate, {}, {Role::rider, &kAccess});
        (void)session.on_message(auth, kNowNs);
        EXPECT_EQ(session.role(), Role::operator_) << auth;
        ASSERT_EQ(gate.acts.size(), 1U);
        EXPECT_EQ(gate.acts[0].kind, ActKind::authenticate);
        EXPECT_EQ(gate.acts[0].outcome, ActOutcome::done);
        EXPECT_EQ(gate.acts[0].role, Role::operator_);
        const Json values =
            values_of(session.on_message(call_of("/surefoot/attest", "[0.4]"), kNowNs));
        EXPECT_EQ(values["success"], true);
    }
}

TEST(RosbridgeSession, AWrongTokenChangesNothingIsSaidAndNoted) {
    ScriptedGate gate;
    RosbridgeSession session(7, gate, {}, {Role::rider, &kAccess});
    for (const char* auth : {R"({"op":"auth"})",
                             R"({"op":"auth","token":""})",
                             R"({"op":"auth","token":7})",
                             R"({"op":"auth","token":"operator-token-of-testt"})"}) {
        const Json reply = Json::parse(session.on_message(auth, kNowNs).replies.at(0));
        EXPECT_EQ(reply["level"], "error");
        EXPECT_NE(reply["msg"].get<std::string>().find("not known"), std::string::npos);
    }
    const Json values = values_of(
        session.on_message(call_of("/surefoot/authenticate", R"({"token":"x"})"), kNowNs));
    EXPECT_EQ(values["success"], false);
    EXPECT_EQ(values["role"], "rider");
    EXPECT_EQ(session.role(), Role::rider);
    ASSERT_EQ(gate.acts.size(), 5U);
    for (const Act& act : gate.acts) EXPECT_EQ(act.outcome, ActOutcome::no_right);
}

TEST(RosbridgeSession, WhoeverGuessesTokensIsDropped) {
    SessionLimits limits;
    limits.faults = {.per_s = 1, .burst = 4};
    const std::string guess = call_of("/surefoot/authenticate", R"({"token":"x"})");
    for (const std::string& text : {guess, std::string(R"({"op":"auth","token":"x"})")}) {
        ScriptedGate gate;
        RosbridgeSession session(1, gate, limits, {Role::rider, &kAccess});
        for (int i = 0; i < 4; ++i) EXPECT_FALSE(session.on_message(text, kNowNs).drop) << i;
        EXPECT_TRUE(session.on_message(text, kNowNs).drop);
    }
}

}  // namespace
}  // namespace surefoot::gate_process
