// SPDX-License-Identifier: Apache-2.0
#include "service/page/gate_listener.hpp"

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <functional>
#include <thread>
#include <vector>

#include "service/gate_process/sockets/websocket_server.hpp"
#include "service/gate_process/steady_clock.hpp"
#include "service/gate_process/wire_testing.hpp"
#include "service/page/foxglove_schemas.hpp"
#include "service/page/foxglove_testing.hpp"

namespace surefoot::page {
namespace {

namespace net = boost::asio;
using testing::Json;

TEST(GateNews, AreReadFromWhatIsPublished) {
    const auto verdict =
        read_gate_news(R"({"op":"publish","topic":"/surefoot/verdict","msg":{"verdict":"OK"}})");
    ASSERT_TRUE(verdict);
    EXPECT_EQ(verdict->topic, GateTopic::verdict);
    EXPECT_EQ(verdict->body, R"({"verdict":"OK"})");
    const auto outlook =
        read_gate_news(R"({"op":"publish","topic":"/surefoot/outlook","msg":{"a":[1]}})");
    ASSERT_TRUE(outlook);
    EXPECT_EQ(outlook->topic, GateTopic::outlook);
    for (const char* other : {"",
                              "{",
                              "[]",
                              "{}",
                              R"({"op":"publish","topic":"/surefoot/health","msg":{}})",
                              R"({"op":"status","topic":"/surefoot/verdict","msg":{}})",
                              R"({"op":"publish","topic":"/surefoot/verdict","msg":"OK"})",
                              R"({"op":"publish","topic":["/surefoot/verdict"],"msg":{}})",
                              R"({"op":"publish","topic":"/surefoot/verdict"})"})
        EXPECT_FALSE(read_gate_news(other)) << other;
}

/// A gate that follows a script, on a thread of its own.
class Gate {
  public:
    explicit Gate(std::string token = {}) {
        gate_process::ServerConfig config;
        config.port = 0;
        if (!token.empty()) {
            config.access.observer = std::move(token);
            config.access.guest = gate_process::Role::none;
        }
        auto opened = gate_process::WebsocketServer::open(config, script_);
        EXPECT_TRUE(opened);
        server_ = std::move(opened).value();
        thread_ = std::thread([this] { server_->run(); });
    }
    Gate(const Gate&) = delete;
    Gate& operator=(const Gate&) = delete;
    ~Gate() {
        server_->stop();
        thread_.join();
    }
    [[nodiscard]] std::uint16_t port() const { return server_->port(); }
    /// Another client asks for a movement; returns when the gate has answered.
    void ask(int direction, const std::string& target = "/") const {
        net::io_context io;
        boost::beast::websocket::stream<net::ip::tcp::socket> client(io);
        client.next_layer().connect({net::ip::make_address("127.0.0.1"), port()});
        client.handshake("127.0.0.1", target);
        client.write(net::buffer(R"({"op":"call_service","service":"/step","args":{"direction":)" +
                                 std::to_string(direction) + "}}"));
        boost::beast::flat_buffer answer;
        client.read(answer);
    }

  private:
    gate_process::testing::ScriptedGate script_;
    std::unique_ptr<gate_process::WebsocketServer> server_;
    std::thread thread_;
};

/// Listens until `done`, ten seconds at most.
struct Listening {
    net::io_context io;
    std::vector<GateNews> news;
    GateListener listener{io, [this](GateNews what) { news.push_back(std::move(what)); }};

    bool until(const GateService& service, GateTopics topics, const std::function<bool()>& done) {
        const std::int64_t end_ns = gate_process::steady_ns() + 10'000'000'000;
        while (!done() && gate_process::steady_ns() < end_ns) {
            listener.want(service, topics, gate_process::steady_ns());
            io.restart();
            io.run_for(std::chrono::milliseconds(5));
        }
        return done();
    }
};

TEST(GateListener, HearsTheOutlookAndVerdictsAsTheGateGivesThem) {
    const Gate gate;
    const GateService service{"127.0.0.1", gate.port(), {}};
    Listening listening;
    ASSERT_TRUE(listening.until(service, {false, true}, [&] { return !listening.news.empty(); }));
    EXPECT_EQ(listening.news[0].topic, GateTopic::outlook);
    const Json outlook = Json::parse(listening.news[0].body);
    EXPECT_EQ(outlook.at("state"), "READY");
    EXPECT_EQ(
        testing::problem_of(outlook, Json::parse(schema_of(FoxgloveChannel::outlook)), "outlook"),
        "");
    // The other topic is subscribed to on the same connection; a verdict before that is lost.
    const auto heard_verdict = [&] {
        gate.ask(17);
        return listening.news.back().topic == GateTopic::verdict;
    };
    listening.news.clear();
    listening.news.push_back({GateTopic::outlook, ""});
    ASSERT_TRUE(listening.until(service, {true, false}, heard_verdict));
    const Json verdict = Json::parse(listening.news.back().body);
    EXPECT_EQ(verdict.at("verdict"), "NOT_TRAVERSABLE");
    EXPECT_EQ(
        testing::problem_of(verdict, Json::parse(schema_of(FoxgloveChannel::verdict)), "verdict"),
        "");
}

TEST(GateListener, KnowsTheTokenAndFindsAGateThatBeganAnew) {
    const std::string token = "0123456789abcdef";
    Listening listening;
    const auto heard = [&] { return !listening.news.empty(); };
    {
        const Gate first(token);
        ASSERT_TRUE(listening.until({"0.0.0.0", first.port(), token}, {false, true}, heard));
    }
    const Gate second(token);
    listening.news.clear();
    EXPECT_TRUE(listening.until({"0.0.0.0", second.port(), token}, {false, true}, heard));
    listening.news.clear();
    const std::int64_t end_ns = gate_process::steady_ns() + 600'000'000;
    listening.until(
        {"0.0.0.0", second.port(), token}, {}, [&] { return gate_process::steady_ns() > end_ns; });
    EXPECT_TRUE(listening.news.empty()) << "nobody wants to hear it";
}

}  // namespace
}  // namespace surefoot::page
