// SPDX-License-Identifier: Apache-2.0
// Clients that break the protocol, stop half way, flood or do not read.
#include <gtest/gtest.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/socket_base.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "service/gate_process/sockets/websocket_server.hpp"
#include "service/gate_process/sockets/websocket_testing.hpp"

namespace surefoot::gate_process::testing {
namespace {

TEST(WebsocketServer, RequestsThatAreNoneEnd) {
    ServerConfig config = any_port();
    config.handshake_ms = 100;
    Service service(config);
    Client other(service, "/", "");
    for (const std::string& bytes :
         {std::string(),
          std::string("\0\1\2", 3),
          std::string("GET / HTTP/1.1\r\nHost: x\r\n"),
          std::string("GET / HTTP/1.1\r\n") + "a: " + std::string(20'000, 'b'),
          std::string("POST /health HTTP/1.1\r\nContent-Length: 9999999\r\n\r\nabc")}) {
        Client client(service);
        client.send_bytes(bytes);
        (void)client.read_bytes();  // returns: the server closed
    }
    expect_allowed(other);
}

TEST(WebsocketServer, AMessageThatIsTooLongEndsItsConnection) {
    Service service;
    Client other(service, "/", "");
    Client client(service, "/", "");
    error_code ignored;
    client.ws().write(net::buffer(std::string(10'000'000, ' ')), ignored);
    // The server does not read ten megabytes first, so the close frame may be lost.
    const int code = client.end_of_reading();
    EXPECT_TRUE(code == websocket::close_code::too_big || code == 0) << code;
    expect_allowed(other);
    service.end();
    EXPECT_EQ(service.gate.questions.size(), 1U);
}

TEST(WebsocketServer, NonsenseGetsAStatusAndThenTheDoor) {
    ServerConfig config = any_port();
    config.session.faults = {.per_s = 1, .burst = 3};
    Service service(config);
    Client other(service, "/", "");
    Client client(service, "/", "");
    for (int i = 0; i < 3; ++i) EXPECT_EQ(client.ask("{")["op"], "status");
    EXPECT_EQ(client.ask("{")["op"], "status");
    EXPECT_EQ(client.end_of_reading(), websocket::close_code::policy_error);
    service.wait_for(2, 1);
    expect_allowed(other);
    service.end();
    EXPECT_EQ(service.counts().dropped, 1U);
    EXPECT_EQ(service.gate.forgotten.front(), 2U);
}

TEST(WebsocketServer, HalfAFrameIsNotWaitedForForEver) {
    ServerConfig config = any_port();
    config.message_ms = 50;
    Service service(config);
    Client other(service, "/", "");
    Client client(service, "/", "");
    // A masked text frame of 100 bytes; only two of them are sent.
    client.send_bytes(std::string("\x81\xe4\0\0\0\0ab", 8));
    (void)client.read_bytes();
    expect_allowed(other);
    service.end();
    EXPECT_EQ(service.counts().dropped, 1U);
}

TEST(WebsocketServer, AMessageInPiecesHasATimeAsAWhole) {
    ServerConfig config = any_port();
    config.message_ms = 50;
    Service service(config);
    Client client(service, "/", "");
    // Endless pieces of one message with pings between them: each piece is a sign of life.
    error_code error;
    client.send_bytes(std::string("\x01\x81\0\0\0\0{", 7));
    while (!error && service.counts().dropped == 0) {
        client.send_bytes(std::string("\0\x81\0\0\0\0 ", 7));
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    service.end();
    EXPECT_EQ(service.counts().dropped, 1U);
}

TEST(WebsocketServer, FramesThatBreakTheRulesEndTheirConnection) {
    Service service;
    Client other(service, "/", "");
    for (const std::string& bytes : {std::string("\x81\x01{", 3),          // not masked
                                     std::string("\x83\x81\0\0\0\0{", 7),  // opcode 3
                                     std::string("\xf1\x81\0\0\0\0{", 7),  // reserved bits
                                     std::string("\x80\x81\0\0\0\0{", 7),  // goes on from nothing
                                     std::string("\x89\xfe\0\x7e\0\0\0\0", 8),       // long ping
                                     std::string("\x81\x82\0\0\0\0\xc0\xaf", 8)}) {  // no UTF-8
        Client client(service, "/", "");
        client.send_bytes(bytes);
        (void)client.read_bytes();
        expect_allowed(other);
    }
}

TEST(WebsocketServer, WhoGivesNoSignOfLifeIsLeft) {
    ServerConfig config = any_port();
    config.idle_ms = 100;
    Service service(config);
    Client client(service, "/", "");
    const std::string bytes = client.read_bytes();
    ASSERT_FALSE(bytes.empty());
    EXPECT_EQ(bytes[0], '\x89');  // the answer to a ping
    service.end();
    EXPECT_EQ(service.gate.forgotten.size(), 1U);
}

TEST(WebsocketServer, AFloodOfPingsEndsItsConnection) {
    Service service;
    Client other(service, "/", "");
    Client client(service, "/", "");
    std::string pings;
    for (int i = 0; i < 100; ++i) pings += std::string("\x89\x80\0\0\0\0", 6);
    client.send_bytes(pings);
    (void)client.read_bytes();
    expect_allowed(other);
    service.end();
    EXPECT_EQ(service.counts().dropped, 1U);
}

TEST(WebsocketServer, WhoDoesNotReadIsLeftAndTheOthersGoOn) {
    ServerConfig config = any_port();
    config.max_queue_bytes = 64 * 1024;
    config.write_ms = 60'000;  // the queue is full before
    config.session.messages = {.per_s = 1'000'000, .burst = 1'000'000};
    Service service(config);
    Client slow(service);
    slow.socket().set_option(net::socket_base::receive_buffer_size(4096));
    slow.open();
    slow.send(R"({"op":"subscribe","topic":"/surefoot/verdict"})");
    Client client(service, "/", "");
    for (int i = 0; i < 100'000 && service.counts().dropped == 0; ++i) expect_allowed(client);
    EXPECT_EQ(service.counts().dropped, 1U);
    expect_allowed(client);
}

TEST(WebsocketServer, WhoAsksWithoutReadingIsLeft) {
    ServerConfig config = any_port();
    config.write_ms = 50;
    config.max_queue_bytes = 64 << 20;  // never full
    // Under load a client may miss the acknowledgement of its own data and stop in the middle of a
    // message. Another deadline covers this case.
    config.message_ms = 60'000;
    config.session.messages = {.per_s = 1'000'000, .burst = 1'000'000};
    Service service(config);
    Client other(service, "/", "");
    Client client(service);
    client.socket().set_option(net::socket_base::receive_buffer_size(4096));
    client.open();
    // Answers of some megabytes, more than the sockets can hold.
    const std::string question =
        R"({"op":"call_service","id":"q","service":"/surefoot/step","args":[9]})";
    error_code error;
    for (int i = 0; i < 8000 && !error; ++i) client.ws().write(net::buffer(question), error);
    while (service.counts().dropped == 0) std::this_thread::yield();
    expect_allowed(other);
}

TEST(WebsocketServer, AClientThatVanishesIsForgotten) {
    Service service;
    Client other(service, "/", "");
    {
        Client client(service, "/", "");
        client.send_bytes(std::string("\x81\xbf\0\0\0\0{\"op\":", 12));
        client.socket().set_option(net::socket_base::linger(true, 0));
    }
    service.wait_for(2, 1);
    expect_allowed(other);
    service.end();
    EXPECT_EQ(service.gate.forgotten.front(), 2U);
    EXPECT_EQ(service.gate.questions.size(), 1U);
}

}  // namespace
}  // namespace surefoot::gate_process::testing
