// SPDX-License-Identifier: Apache-2.0
// Many clients, and many questions: who is served, and in which order.
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "service/gate_process/protocol/json_text.hpp"
#include "service/gate_process/sockets/slots.hpp"
#include "service/gate_process/sockets/websocket_server.hpp"
#include "service/gate_process/sockets/websocket_testing.hpp"
#include "service/gate_process/wire_testing.hpp"

namespace surefoot::gate_process::testing {
namespace {

TEST(WebsocketServer, TooManyQuestionsAreAnsweredAsErrors) {
    ServerConfig config = any_port();
    config.session.messages = {.per_s = 1, .burst = 2};
    Service service(config);
    Client client(service, "/", "");
    expect_allowed(client);
    expect_allowed(client);
    const Json response =
        client.ask(R"({"op":"call_service","id":"q","service":"/surefoot/step","args":[9]})");
    EXPECT_EQ(response["values"]["primary"], "OVERLOAD");
}

TEST(WebsocketServer, NoMoreClientsThanTheLimit) {
    ServerConfig config = any_port();
    config.slots.max_clients = 2;
    config.slots.reserved = 0;
    Service service(config);
    Client first(service, "/", "");
    {
        Client second(service, "/", "");
        expect_allowed(first);
        expect_allowed(second);
        EXPECT_EQ(status_of_upgrade(service, "/"), 503U) << "both are being served";
        second.ws().close(websocket::close_code::normal);
    }
    service.wait_for(3, 1);
    EXPECT_EQ(status_of_upgrade(service, "/"), 101U);
    expect_allowed(first);
}

SlotLimits few_slots() {
    SlotLimits slots;
    slots.max_clients = 4;
    slots.reserved = 1;
    return slots;
}

TEST(WebsocketServer, SleepersLockNobodyOut) {
    ServerConfig config = any_port();
    config.slots = few_slots();
    Service service(config);
    Client inside(service, "/", "");
    expect_allowed(inside);
    std::vector<std::unique_ptr<Client>> sleepers;
    for (int i = 0; i < 20; ++i) sleepers.push_back(std::make_unique<Client>(service, "/", ""));
    Client newcomer(service, "/", "");
    expect_allowed(newcomer);
    expect_allowed(inside);
    EXPECT_EQ(sleepers.front()->goodbye(), websocket::close_code::policy_error)
        << "it is told that its slot went to another one";
    service.end();
    EXPECT_EQ(service.counts().refused, 0U);
}

TEST(WebsocketServer, ASlotIsKeptForWhoeverShowsAToken) {
    ServerConfig config = any_port();
    config.slots = few_slots();
    config.slots.useful_ns = 3'600'000'000'000;
    config.access = testing::three_tokens();
    Service service(config);
    std::vector<std::unique_ptr<Client>> guests;
    for (int i = 0; i < 3; ++i) {
        guests.push_back(std::make_unique<Client>(service, "/", ""));
        expect_allowed(*guests.back());
    }
    EXPECT_EQ(status_of_upgrade(service, "/"), 503U);
    EXPECT_EQ(status_of_upgrade(service, "/?token=" + testing::three_tokens().observer), 503U);
    Client rider(service, "/?token=" + kRider, "");
    expect_allowed(rider);
    Client operator_(service, "/?token=" + kToken, "");
    expect_allowed(operator_);
    EXPECT_EQ(guests.front()->goodbye(), websocket::close_code::policy_error);
    expect_allowed(*guests.back());
}

TEST(WebsocketServer, ARiderWithATokenDoesNotWaitForAFloodOfGuests) {
    ServerConfig config = any_port();
    config.access = testing::three_tokens();
    config.guest_work_us = 300;  // some questions a tick
    config.session.messages = {.per_s = 100'000, .burst = 100'000};
    Service service(config);
    Client guest(service, "/", "");
    for (int i = 0; i < 2000; ++i) guest.send(kStep);
    Client rider(service, "/?token=" + kRider, "");
    for (int i = 0; i < 100; ++i) expect_allowed(rider);
    EXPECT_EQ(guest.receive()["values"]["resultCode"], 0) << "guests are served, too";
    service.end();
    const auto questions_of = [&](std::uint64_t connection) {
        return std::count_if(service.gate.questions.begin(),
                             service.gate.questions.end(),
                             [&](const StepQuestion& q) { return q.connection == connection; });
    };
    EXPECT_EQ(questions_of(2), 100);
    EXPECT_LT(questions_of(1), 2000) << "what is left waits for its turn";
}

TEST(WebsocketServer, AGuestThatAsksSeldomComesBeforeOneThatNeverStops) {
    ServerConfig config = any_port();
    config.guest_work_us = 300;  // some questions a tick
    config.session.messages = {.per_s = 100'000, .burst = 100'000};
    Service service(config);
    Client flood(service, "/", "");
    for (int i = 0; i < 2000; ++i) flood.send(kStep);
    Client seldom(service, "/", "");
    for (int i = 0; i < 5; ++i) expect_allowed(seldom);
    service.end();
    EXPECT_LT(service.gate.questions.size(), 2000U) << "the flood has not been worked off before";
}

TEST(WebsocketServer, AtAFullDoorTheOldestGivesWay) {
    ServerConfig config = any_port();
    config.slots.max_handshakes = 2;
    config.handshake_ms = 60'000;
    Service service(config);
    Client oldest(service);
    Client other(service);
    Client newest(service, "/", "");
    EXPECT_EQ(oldest.read_bytes(), "");
    expect_allowed(newest);
    other.open();
    expect_allowed(other);
    service.end();
    EXPECT_EQ(service.counts().refused, 1U);
}

TEST(WebsocketServer, AThousandAtTheDoorDisturbNobody) {
    Service service;
    Client inside(service, "/", "");
    net::io_context io;
    std::vector<tcp::socket> crowd;
    for (int i = 0; i < 1000; ++i) {
        crowd.emplace_back(io);
        error_code error;
        crowd.back().connect(service.endpoint(), error);
        ASSERT_FALSE(error) << i << ": " << error.message();
        if (i % 20 == 0) expect_allowed(inside);
    }
    Client late(service, "/", "");
    expect_allowed(late);
    service.end();
    EXPECT_EQ(service.counts().accepted, 1002U);
    EXPECT_EQ(service.gate.forgotten.size(), 2U);
}

}  // namespace
}  // namespace surefoot::gate_process::testing
