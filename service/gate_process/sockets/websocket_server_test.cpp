// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/sockets/websocket_server.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <atomic>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "service/gate_process/protocol/json_text.hpp"
#include "service/gate_process/sockets/websocket_testing.hpp"
#include "service/gate_process/wire_testing.hpp"

namespace surefoot::gate_process::testing {
namespace {

TEST(WebsocketServer, AnswersAQuestion) {
    Service service;
    Client client(service, "/", "");
    expect_allowed(client);
    EXPECT_EQ(
        client.ask(R"({"op":"call_service","id":"q","service":"/step","args":[17]})")["values"]
                                                                                     ["resultCode"],
        1);
    service.end();
    ASSERT_EQ(service.gate.questions.size(), 2U);
    EXPECT_EQ(service.gate.questions[0].connection, 1U);
    EXPECT_EQ(service.gate.forgotten, std::vector<std::uint64_t>{1});
}

TEST(WebsocketServer, EveryClientIsAConnectionOfItsOwn) {
    ServerConfig config = any_port();
    config.first_connection = 1000;
    Service service(config);
    for (std::uint64_t i = 0; i < 3; ++i) {
        Client client(service, "/", "");
        const Json response =
            client.ask(R"({"op":"call_service","id":"q","service":"/surefoot/step","args":[9]})");
        EXPECT_EQ(response["values"]["connection"], 1000 + i);
        EXPECT_EQ(response["values"]["sequence"], 1);
        client.ws().close(websocket::close_code::normal);
    }
}

TEST(WebsocketServer, APortThatIsTakenIsSaid) {
    Service service;
    ScriptedGate gate;
    ServerConfig config;
    config.port = service.endpoint().port();
    const auto server = WebsocketServer::open(config, gate);
    ASSERT_FALSE(server);
    EXPECT_NE(server.error().message.find(std::to_string(config.port)), std::string::npos);
}

TEST(WebsocketServer, HealthWithoutAWebSocket) {
    Service service;
    const auto response = get(service, "/health");
    EXPECT_EQ(response.result_int(), 200U);
    EXPECT_EQ(Json::parse(response.body())["state"], "READY");
    EXPECT_EQ(get(service, "/").result_int(), 426U);
    EXPECT_EQ(get(service, "/healthy").result_int(), 404U);
    EXPECT_EQ(get(service, "/../etc/passwd").result_int(), 404U);
    EXPECT_EQ(get(service, "/health", http::verb::delete_).result_int(), 404U);
}

TEST(WebsocketServer, SubscribersHearOfVerdictsAndHealth) {
    Service service;
    Client listener(service, "/", "");
    Client asker(service, "/", "");
    listener.send(R"({"op":"subscribe","topic":"/surefoot/health"})");
    for (int i = 0; i < 3; ++i) {
        const Json message = listener.receive();
        EXPECT_EQ(message["topic"], "/surefoot/health");
        EXPECT_EQ(message["msg"]["state"], "READY");
    }
    listener.send(R"({"op":"unsubscribe","topic":"/surefoot/health"})");
    listener.send(R"({"op":"subscribe","topic":"/surefoot/verdict"})");
    // The answer to its own question proves that the subscription was read. The answer comes first,
    // although its verdict is also a message to this client.
    Json message = listener.ask(kStep);
    while (message["topic"] == "/surefoot/health") message = listener.receive();
    EXPECT_EQ(message["op"], "service_response");
    EXPECT_EQ(listener.receive()["msg"]["connection"], 1);
    expect_allowed(asker);
    EXPECT_EQ(listener.receive()["msg"]["connection"], 2);
}

TEST(WebsocketServer, TheOutlookComesToWhoSubscribesAndOnlyWhileTheyDo) {
    Service service;
    Client listener(service, "/", "");
    listener.send(R"({"op":"subscribe","topic":"/surefoot/outlook","type":"surefoot/Outlook"})");
    for (int i = 0; i < 2; ++i) {
        const Json message = listener.receive();
        EXPECT_EQ(message["topic"], "/surefoot/outlook");
        EXPECT_EQ(message["msg"]["verdicts"].size(), 3U);
    }
    listener.send(R"({"op":"unsubscribe","topic":"/surefoot/outlook"})");
    while (listener.ask(kStep)["op"] != "service_response") {
    }
    const int ticks = service.ticks;
    while (service.ticks < ticks + 2) std::this_thread::yield();
    service.end();
    const std::size_t looks = service.gate.looked_at.size();
    EXPECT_GE(looks, 6U);
    EXPECT_LE(looks, 9U) << "two rounds, and what was left of a third";
}

/// The server's end of a client's connection; both are in this process.
int server_end_of(const tcp::socket& client) {
    const tcp::endpoint wanted = client.local_endpoint();
    constexpr int kMostHandles = 1024;
    for (int handle = 0; handle < kMostHandles; ++handle) {
        tcp::endpoint peer;
        socklen_t length = static_cast<socklen_t>(peer.capacity());
        if (::getpeername(handle, peer.data(), &length) == 0 && peer == wanted) return handle;
    }
    return -1;
}

/// The tick's hook sends a question to the server that calls it: its bytes are in the socket when
/// the server computes the outlook.
TEST(WebsocketServer, AQuestionThatWaitsGoesBeforeTheOutlook) {
    ScriptedGate gate;
    std::function<void()> hook;
    const auto server = std::move(WebsocketServer::open(any_port(), gate, [&](std::int64_t) {
                                      if (hook) hook();
                                  }).value());
    net::io_context io;
    websocket::stream<tcp::socket> ws(io);
    ws.next_layer().connect({net::ip::make_address("127.0.0.1"), server->port()});
    ws.next_layer().set_option(tcp::no_delay(true));  // otherwise a second message waits for an ACK
    std::atomic<bool> done = false;
    std::thread thread([&] {
        ws.handshake("127.0.0.1", "/");
        ws.write(net::buffer(std::string(R"({"op":"subscribe","topic":"/surefoot/outlook"})")));
        done = true;
    });
    while (!done || gate.looked_at.empty()) server->poll();
    thread.join();
    pollfd arrival{server_end_of(ws.next_layer()), POLLIN, 0};
    std::size_t asked = 0;
    std::size_t looks = 0;
    bool its_turn = false;
    hook = [&] {
        // Only in every second tick: a client that asks in each tick is served before the outlook
        // only four times out of five.
        its_turn = !its_turn;
        if (!its_turn || asked != gate.questions.size()) return;
        looks = gate.looked_at.size();
        ws.write(net::buffer(std::string(kStep)));
        ASSERT_EQ(::poll(&arrival, 1, -1), 1);
        ++asked;
    };
    std::size_t answered = 0;
    while (answered < 50) {
        server->poll();
        if (gate.questions.size() == answered) continue;
        EXPECT_EQ(gate.looks_before.back(), looks) << "question " << answered;
        ++answered;
    }
}

TEST(WebsocketServer, TheOwnerIsCalledAndCounts) {
    Service service;
    Client client(service, "/", "");
    service.wait_for(1, 1);
    const int ticks = service.ticks;
    while (service.ticks < ticks + 10) std::this_thread::yield();
    client.ws().close(websocket::close_code::normal);
    service.wait_for(1, 0);
    service.end();
    EXPECT_EQ(service.counts().accepted, 1U);
    EXPECT_EQ(service.counts().refused, 0U);
    EXPECT_EQ(service.counts().dropped, 0U);
}

TEST(WebsocketServer, StopEndsEverything) {
    Service service;
    Client client(service, "/", "");
    service.end();
    EXPECT_EQ(client.end_of_reading(), 0);
    EXPECT_EQ(service.counts().clients, 0U);
}

TEST(WebsocketServer, ServesInALoopOfItsOwner) {
    ScriptedGate gate;
    const auto server = std::move(WebsocketServer::open(any_port(), gate).value());
    std::atomic<bool> done = false;
    std::thread thread([&] {
        net::io_context io;
        websocket::stream<tcp::socket> ws(io);
        ws.next_layer().connect({net::ip::make_address("127.0.0.1"), server->port()});
        ws.handshake("127.0.0.1", "/");
        ws.write(net::buffer(std::string(kStep)));
        beast::flat_buffer buffer;
        ws.read(buffer);
        done = true;
    });
    while (!done) server->poll();
    thread.join();
    EXPECT_EQ(gate.questions.size(), 1U);
}

}  // namespace
}  // namespace surefoot::gate_process::testing
