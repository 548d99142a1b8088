// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/sockets/admission.hpp"

#include <gtest/gtest.h>

#include "service/gate_process/protocol/out_queue.hpp"
#include "service/gate_process/sockets/server_config.hpp"
#include "service/gate_process/wire_testing.hpp"

namespace surefoot::gate_process {
namespace {

const std::string kToken = "0123456789abcdef";

TEST(Admission, PagesOfThisMachineAndOfTheListAlone) {
    const std::vector<std::string> origins{"https://clinic.example"};
    const auto page = [&](const char* origin) { return admit("", origins, "/", origin); };
    for (const char* origin : {"http://localhost",
                               "http://localhost:8080",
                               "https://127.0.0.1:1",
                               "http://[::1]:3000",
                               "https://clinic.example"})
        EXPECT_EQ(page(origin), Admission::welcome) << origin;
    for (const char* origin : {"",
                               "null",
                               "file://",
                               "http://localhost.evil.example",
                               "http://localhost:80@evil.example",
                               "http://127.0.0.1.evil.example",
                               "http://localhost:",
                               "http://localhost:80x",
                               "ftp://localhost",
                               "http://evil.example",
                               "http://evil.example/http://localhost",
                               "https://clinic.example:8443",
                               "http://clinic.example",
                               "https://clinic.example.evil",
                               "http://127.0.0.2",
                               "HTTP://LOCALHOST"})
        EXPECT_EQ(page(origin), Admission::wrong_origin) << origin;
    EXPECT_EQ(admit("", {}, "/", std::nullopt), Admission::welcome);
}

TEST(Admission, TheTokenIsAskedOfEverybody) {
    const auto target = [&](const std::string& text) {
        return admit(kToken, {}, text, std::nullopt);
    };
    EXPECT_EQ(target("/?token=" + kToken), Admission::welcome);
    EXPECT_EQ(target("/health?a=b&token=" + kToken + "&c"), Admission::welcome);
    for (const std::string& text : {std::string("/"),
                                    std::string("/?token="),
                                    "/?token=" + kToken.substr(1),
                                    "/?token=" + kToken + "x",
                                    "/?token=" + kToken + kToken,
                                    "/?xtoken=" + kToken,
                                    "/?Token=" + kToken,
                                    "/" + kToken,
                                    "/?" + kToken,
                                    "/?token=" + kToken.substr(0, 15) + "g"})
        EXPECT_EQ(target(text), Admission::wrong_token) << text;
    EXPECT_EQ(admit(kToken, {}, "/?token=" + kToken, "http://evil.example"),
              Admission::wrong_origin);
}

TEST(Admission, PartsOfATarget) {
    EXPECT_EQ(path_of("/health?token=x?y"), "/health");
    EXPECT_EQ(path_of("/health"), "/health");
    EXPECT_EQ(path_of(""), "");
    EXPECT_EQ(query_value("/?a=1&&b=2=3&c", "b"), "2=3");
    EXPECT_EQ(query_value("/?a=1&a=2", "a"), "1");
    EXPECT_EQ(query_value("/?a", "a"), "");
    EXPECT_EQ(query_value("", "a"), "");
}

TEST(ServerConfig, OutsideNeedsATokenOfEverybodyAndTls) {
    const auto said = [](const ServerConfig& config) { return config.problem().value_or(""); };
    ServerConfig config;
    EXPECT_EQ(said(config), "");
    for (const char* address : {"0.0.0.0", "192.168.1.5", "::", "::ffff:127.0.0.1", "128.0.0.1"}) {
        config = {};
        config.bind_address = address;
        EXPECT_NE(said(config).find("every client needs a token"), std::string::npos) << address;
        config.access = testing::three_tokens(Role::observer);
        EXPECT_NE(said(config).find("--guests none"), std::string::npos) << said(config);
        config.access.guest = Role::none;
        EXPECT_NE(said(config).find("--certificate"), std::string::npos) << said(config);
        EXPECT_NE(said(config).find(kInsecureSentence), std::string::npos) << said(config);
        config.insecure = "yes";
        EXPECT_NE(said(config).find(kInsecureSentence), std::string::npos) << said(config);
        config.insecure = kInsecureSentence;
        EXPECT_EQ(said(config), "") << address;
        config.insecure.clear();
        config.tls = {"certificate.pem", "key.pem"};
        EXPECT_EQ(said(config), "") << address;
        config.tls.key_file.clear();
        EXPECT_NE(said(config).find("both files"), std::string::npos) << said(config);
    }
    config = {};
    for (const char* address : {"127.0.0.1", "127.1.2.3", "::1"}) {
        config.bind_address = address;
        EXPECT_EQ(said(config), "") << address;
    }
    for (const char* address : {"", "localhost", "127.0.0", "127.0.0.1 "}) {
        config.bind_address = address;
        EXPECT_NE(said(config), "") << address;
    }
}

TEST(ServerConfig, NoLimitCanBeSwitchedOff) {
    using Change = void (*)(ServerConfig&);
    for (const Change change :
         {Change([](ServerConfig& c) { c.access.rider = "short"; }),
          Change([](ServerConfig& c) { c.access.operator_ = "0123456789abcde&"; }),
          Change([](ServerConfig& c) { c.access.observer = std::string(129, 'a'); }),
          Change([](ServerConfig& c) { c.first_connection = 0; }),
          Change([](ServerConfig& c) { c.access.guest = Role::operator_; }),
          Change([](ServerConfig& c) { c.slots.max_clients = 0; }),
          Change([](ServerConfig& c) { c.slots.max_handshakes = 0; }),
          Change([](ServerConfig& c) { c.accepts_per_tick = 0; }),
          Change([](ServerConfig& c) { c.tick_ms = 0; }),
          Change([](ServerConfig& c) { c.guest_work_us = 0; }),
          Change([](ServerConfig& c) { c.door_work_us = 0; }),
          Change([](ServerConfig& c) { c.handshake_ms = 0; }),
          Change([](ServerConfig& c) { c.idle_ms = -1; }),
          Change([](ServerConfig& c) { c.message_ms = 0; }),
          Change([](ServerConfig& c) { c.write_ms = 0; }),
          Change([](ServerConfig& c) { c.max_queue_bytes = 0; }),
          Change([](ServerConfig& c) { c.max_read_bytes_per_s = 0; }),
          Change([](ServerConfig& c) { c.control_frames.per_s = 0; }),
          Change([](ServerConfig& c) { c.session.messages.burst = 0; }),
          Change([](ServerConfig& c) { c.session.refusals.per_s = -1; }),
          Change([](ServerConfig& c) { c.session.faults.per_s = 0; })}) {
        ServerConfig config;
        change(config);
        EXPECT_TRUE(config.problem().has_value());
    }
}

TEST(OutQueue, RepliesLeaveBeforeTopics) {
    OutQueue queue(100);
    ASSERT_TRUE(queue.push_topic("t1"));
    ASSERT_TRUE(queue.push_reply("r1"));
    ASSERT_TRUE(queue.push_topic("t2"));
    ASSERT_TRUE(queue.push_reply("r2"));
    for (const char* expected : {"r1", "r2", "t1", "t2"}) EXPECT_EQ(queue.pop(), expected);
    EXPECT_TRUE(queue.empty());
}

TEST(OutQueue, HoldsNoMoreThanItsBytes) {
    OutQueue queue(5);
    EXPECT_TRUE(queue.push_reply("123"));
    EXPECT_FALSE(queue.push_topic("456"));
    EXPECT_TRUE(queue.push_topic("45"));
    EXPECT_FALSE(queue.push_reply("6"));
    EXPECT_EQ(queue.pop(), "123");
    EXPECT_TRUE(queue.push_reply("678"));
    EXPECT_EQ(queue.pop(), "678");
    EXPECT_EQ(queue.pop(), "45");
    EXPECT_TRUE(queue.empty());
}

}  // namespace
}  // namespace surefoot::gate_process
