// SPDX-License-Identifier: Apache-2.0
// In real time against a fake gate. No test measures time, because a busy computer may be silent
// for 100 ms. The simulated user then rests and tries again until the wanted event occurs, at most
// 30 s.
#include "service/rex_link/link_client.hpp"

#include <gtest/gtest.h>

#include "service/rex_link/answer_parser.hpp"
#include "service/rex_link/fake_gate_testing.hpp"

namespace surefoot::rex_link {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kPatience_ns = 30'000 * kMs;

/// The part of `text` between `before` and `after`.
std::string between(const std::string& text, const std::string& before, const std::string& after) {
    const std::size_t begin = text.find(before);
    if (begin == std::string::npos) return "";
    const std::size_t end = text.find(after, begin + before.size());
    return text.substr(begin + before.size(), end - begin - before.size());
}

std::string ok_to(const std::string& question) {
    return R"({"op":"service_response","id":")" + between(question, R"("id":")", "\"") +
           R"(","service":"/surefoot/step","result":true,"values":{"verdict":"OK","result_code":0,)"
           R"("reasons":[],"primary":"NONE","text":"safe","connection":3,"valid_for_ms":300,)"
           R"("command":)" +
           between(question, R"("direction":)", ",") + R"(,"sequence":)" +
           between(question, R"("sequence":)", "}") + "}}";
}

/// Pushes the joystick ahead until the wanted event occurs; rests after each warning.
class Walk {
  public:
    explicit Walk(std::uint16_t port) {
        config.gate = parse_gate_url("ws://127.0.0.1:" + std::to_string(port)).value();
        config.link.step_duration_ns = 100 * kMs;
        config.reconnect_pause_ns = 20 * kMs;
    }

    using Wanted = std::function<bool(const LinkEvent&)>;
    /// True if the event occurred.
    bool until(const Wanted& wanted) {
        bool seen = false;
        std::int64_t rest_until_ns = 0;
        bool connected = false;
        run_link(
            config,
            [&](std::int64_t elapsed_ns) -> std::optional<std::uint8_t> {
                elapsed_ns_ = elapsed_ns;
                if (seen || elapsed_ns > kPatience_ns) return std::nullopt;
                if (wait_for_connection && !connected) return 0;
                return elapsed_ns < rest_until_ns ? 0 : 9;
            },
            [&](const LinkEvent& event) {
                events.push_back(event);
                if (event.kind == LinkEventKind::connected) connected = true;
                if (event.kind == LinkEventKind::inhibited) rest_until_ns = elapsed_ns_ + 220 * kMs;
                seen = seen || wanted(event);
            });
        return seen;
    }
    bool until_inhibit(Inhibit why) {
        return until([why](const LinkEvent& event) {
            return event.kind == LinkEventKind::inhibited && event.inhibit == why;
        });
    }
    [[nodiscard]] std::size_t count(LinkEventKind kind) const {
        std::size_t n = 0;
        for (const LinkEvent& event : events) n += event.kind == kind ? 1 : 0;
        return n;
    }

    bool wait_for_connection = true;
    LinkClientConfig config;
    std::vector<LinkEvent> events;

  private:
    std::int64_t elapsed_ns_ = 0;
};

bool is_motion(const LinkEvent& event) {
    return event.kind == LinkEventKind::motion;
}

TEST(LinkClient, MovesOnTwoAnswersOverAWebSocket) {
    FakeGate gate([](const std::string& question, int) { return Reply{{ok_to(question)}}; });
    Walk walk(gate.port());
    ASSERT_TRUE(walk.until(is_motion));
    using Kind = LinkEventKind;
    const Kind expected[] = {
        Kind::question, Kind::answer, Kind::tone, Kind::question, Kind::answer, Kind::motion};
    ASSERT_GE(walk.events.size(), std::size(expected));
    const std::size_t first = walk.events.size() - std::size(expected);
    for (std::size_t i = 0; i < std::size(expected); ++i)
        EXPECT_STREQ(to_string(walk.events[first + i].kind), to_string(expected[i])) << i;
    EXPECT_EQ(walk.events[first + 1].sequence, walk.events[first].sequence);
    EXPECT_EQ(walk.events[first + 1].text, "safe");
    EXPECT_EQ(walk.events.back().command, 9);
    EXPECT_EQ(walk.events.back().duration_ns, 100 * kMs);
}

TEST(LinkClient, AHeldJoystickAsksTwiceForEveryStep) {
    FakeGate gate([](const std::string& question, int) { return Reply{{ok_to(question)}}; });
    Walk walk(gate.port());
    ASSERT_TRUE(
        walk.until([&](const LinkEvent&) { return walk.count(LinkEventKind::motion) == 3; }));
    EXPECT_GE(walk.count(LinkEventKind::question), 6U);
}

TEST(LinkClient, ASilentGateInhibits) {
    FakeGate gate([](const std::string&, int) { return Reply{}; });
    Walk walk(gate.port());
    EXPECT_TRUE(walk.until_inhibit(Inhibit::silence));
    EXPECT_EQ(walk.count(LinkEventKind::motion), 0U);
    EXPECT_EQ(walk.events.back().tone, Tone::cannot_judge);
}

TEST(LinkClient, AHalfAnswerInhibits) {
    FakeGate gate([](const std::string& question, int) {
        const std::string whole = ok_to(question);
        return Reply{{whole.substr(0, whole.size() / 2)}};
    });
    Walk walk(gate.port());
    EXPECT_TRUE(walk.until_inhibit(Inhibit::damaged));
    EXPECT_GE(walk.count(LinkEventKind::damaged), 1U);
    EXPECT_EQ(walk.count(LinkEventKind::motion), 0U);
}

TEST(LinkClient, AnOkInABinaryFrameIsNoAnswer) {
    FakeGate gate([](const std::string& question, int) { return Reply{{ok_to(question)}, true}; });
    Walk walk(gate.port());
    EXPECT_TRUE(walk.until_inhibit(Inhibit::damaged));
    EXPECT_EQ(walk.count(LinkEventKind::answer), 0U);
}

TEST(LinkClient, AnAnswerPlayedBackFitsNothing) {
    std::string old;
    FakeGate gate([&old](const std::string& question, int) {
        if (old.empty()) old = ok_to(question);
        return Reply{{old}};
    });
    Walk walk(gate.port());
    // The OK to the first question is sent again for the second question; it must count only once.
    EXPECT_TRUE(walk.until_inhibit(Inhibit::silence));
    EXPECT_EQ(walk.count(LinkEventKind::motion), 0U);
}

TEST(LinkClient, AMessageBeyondAllMeasureEndsTheConnection) {
    FakeGate gate([](const std::string&, int) {
        return Reply{{std::string(2 * kLongestAnswer_bytes, ' ')}};
    });
    Walk walk(gate.port());
    EXPECT_TRUE(walk.until_inhibit(Inhibit::disconnected));
    EXPECT_EQ(walk.count(LinkEventKind::damaged), 0U);
}

TEST(LinkClient, AGateThatHangsUpInhibitsAndIsFoundAgain) {
    FakeGate gate([](const std::string& question, int count) {
        return count == 1 ? Reply{{}, false, true} : Reply{{ok_to(question)}};
    });
    Walk walk(gate.port());
    EXPECT_TRUE(walk.until(is_motion));
    EXPECT_GE(walk.count(LinkEventKind::disconnected), 1U);
    EXPECT_GE(walk.count(LinkEventKind::connected), 2U);
    EXPECT_GE(walk.count(LinkEventKind::inhibited), 1U);
}

TEST(LinkClient, TheEndOfAConnectionInhibitsBeforeThereIsAnother) {
    FakeGate gate([](const std::string&, int) { return Reply{{}, false, true}; });
    Walk walk(gate.port());
    walk.config.reconnect_pause_ns = 2 * kPatience_ns;
    EXPECT_TRUE(walk.until_inhibit(Inhibit::disconnected));
    EXPECT_EQ(walk.count(LinkEventKind::connected), 1U);
}

TEST(LinkClient, WithoutAGateEveryPushIsWarned) {
    std::uint16_t port = 0;
    {
        FakeGate gone([](const std::string&, int) { return Reply{}; });
        port = gone.port();
    }
    Walk walk(port);
    walk.wait_for_connection = false;
    EXPECT_TRUE(walk.until_inhibit(Inhibit::disconnected));
    EXPECT_EQ(walk.count(LinkEventKind::connected), 0U);
    EXPECT_EQ(walk.count(LinkEventKind::question), 0U);
}

TEST(LinkClient, EndsWhenTheUserHasFinished) {
    FakeGate gate([](const std::string&, int) { return Reply{}; });
    LinkClientConfig config;
    config.gate.address = "127.0.0.1";
    config.gate.port = gate.port();
    int events = 0;
    run_link(
        config, [](std::int64_t) { return std::nullopt; }, [&](const LinkEvent&) { ++events; });
    EXPECT_EQ(events, 0);
}

TEST(GateUrl, NamesAnAddressInNumbers) {
    const struct {
        const char *url, *address;
        std::uint16_t port;
        const char* target;
    } good[] = {{"ws://127.0.0.1:9090", "127.0.0.1", 9090, "/"},
                {"ws://127.0.0.1", "127.0.0.1", 9090, "/"},
                {"ws://localhost:80", "127.0.0.1", 80, "/"},
                {"ws://10.0.0.7:65535/?token=ab", "10.0.0.7", 65535, "/?token=ab"},
                {"ws://[::1]:9091/x", "::1", 9091, "/x"},
                {"ws://[::1]", "::1", 9090, "/"}};
    for (const auto& c : good) {
        const auto gate = parse_gate_url(c.url);
        ASSERT_TRUE(gate) << gate.error().message;
        EXPECT_EQ(gate.value().address, c.address);
        EXPECT_EQ(gate.value().port, c.port);
        EXPECT_EQ(gate.value().target, c.target);
    }
    for (const char* url : {"",
                            "127.0.0.1:9090",
                            "http://127.0.0.1",
                            "wss://127.0.0.1",
                            "ws://",
                            "ws://rex.example",
                            "ws://127.0.0.1:",
                            "ws://127.0.0.1:0",
                            "ws://127.0.0.1:65536",
                            "ws://127.0.0.1:80x",
                            "ws://127.0.0",
                            "ws://::1",
                            "ws://[127.0.0.1]",
                            "ws://127.0.0.1/a b",
                            "ws://127.0.0.1/\r\nX: y"}) {
        EXPECT_FALSE(parse_gate_url(url)) << url;
    }
}

}  // namespace
}  // namespace surefoot::rex_link
