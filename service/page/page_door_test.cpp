// SPDX-License-Identifier: Apache-2.0
#include "service/page/page_door.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

namespace surefoot::page {
namespace {

const PageAddress kLocal{"127.0.0.1", 8080, {"robot"}, {}};
const PageAddress kNetwork{"0.0.0.0", 8080, {"robot", "robot.local"}, {"https://robot.example"}};

std::string header(std::string_view host, std::string_view name) {
    for (const auto& [key, value] : security_headers(host)) {
        if (key == name) return value;
    }
    return "";
}

TEST(PageDoor, a_host_has_a_name_and_perhaps_a_port) {
    const auto named = parse_host("LocalHost:80");
    ASSERT_TRUE(named);
    EXPECT_EQ(named->host, "localhost");
    EXPECT_EQ(named->port, 80);
    const auto six = parse_host("[::1]");
    ASSERT_TRUE(six);
    EXPECT_EQ(six->host, "[::1]");
    EXPECT_FALSE(six->port);
    for (const char* wrong : {"",
                              ":80",
                              "a:",
                              "a:0",
                              "a:65536",
                              "a:8o",
                              "a:80:80",
                              "[::1",
                              "[::1]80",
                              "[robot]",
                              "[fe80::1%a b]",
                              "[fe80::1%25eth0]",
                              "a b",
                              "a;b",
                              "a'",
                              "user@a",
                              "a/b"})
        EXPECT_FALSE(parse_host(wrong)) << wrong;
    // Code that reads C strings would see only a valid address here.
    EXPECT_FALSE(parse_host(std::string_view("[fe80::\0 evil]:80", 17)));
    EXPECT_FALSE(parse_host(std::string_view("127.0.0.1\0.evil", 15)));
}

// DNS rebinding: evil.example now resolves to 127.0.0.1, but the request still has that name.
TEST(PageDoor, a_strangers_name_is_no_host_of_the_page) {
    for (const char* right :
         {"127.0.0.1:8080", "localhost:8080", "[::1]:8080", "127.0.0.9:8080", "localhost"})
        EXPECT_TRUE(is_own_host(kLocal, right)) << right;
    for (const char* wrong : {"evil.example:8080",
                              "evil.example",
                              "localhost.evil.example:8080",
                              "127.0.0.1.evil.example:8080",
                              "localhost:8081",
                              "127.0.0.1:9090",
                              "192.0.2.7:8080",
                              "robot:8080",
                              "0.0.0.0:8080",
                              "",
                              "localhost:8080:8080"})
        EXPECT_FALSE(is_own_host(kLocal, wrong)) << wrong;
}

TEST(PageDoor, beyond_loopback_addresses_and_the_names_of_the_computer_are_right) {
    for (const char* right : {"192.0.2.7:8080",
                              "[2001:db8::7]:8080",
                              "Robot:8080",
                              "robot.local:8080",
                              "localhost:8080",
                              "robot.example:443",
                              "robot.example"})
        EXPECT_TRUE(is_own_host(kNetwork, right)) << right;
    for (const char* wrong : {"evil.example:8080", "192.0.2.7:8081", "robot.example:8080"})
        EXPECT_FALSE(is_own_host(kNetwork, wrong)) << wrong;
}

TEST(PageDoor, a_browser_leaves_out_the_port_of_its_scheme) {
    PageAddress page = kLocal;
    page.port = 80;
    EXPECT_TRUE(is_own_host(page, "localhost"));
    EXPECT_TRUE(is_own_origin(page, "localhost", "http://localhost"));
    EXPECT_FALSE(is_own_origin(page, "localhost", "https://localhost"));
}

TEST(PageDoor, only_the_pages_own_port_is_its_origin) {
    for (const char* right : {"http://127.0.0.1:8080",
                              "http://localhost:8080",
                              "http://[::1]:8080",
                              "https://localhost:8080"})
        EXPECT_TRUE(is_own_origin(kLocal, "127.0.0.1:8080", right)) << right;
    for (const char* wrong : {"http://127.0.0.1:3000",
                              "http://localhost",
                              "http://localhost:80",
                              "http://evil.example:8080",
                              "http://192.0.2.7:8080",
                              "ftp://localhost:8080",
                              "null",
                              "file://",
                              ""})
        EXPECT_FALSE(is_own_origin(kLocal, "127.0.0.1:8080", wrong)) << wrong;
}

TEST(PageDoor, another_computer_on_the_network_is_another_origin) {
    EXPECT_TRUE(is_own_origin(kNetwork, "192.0.2.7:8080", "http://192.0.2.7:8080"));
    EXPECT_FALSE(is_own_origin(kNetwork, "192.0.2.7:8080", "http://192.0.2.66:8080"));
    EXPECT_TRUE(is_own_origin(kNetwork, "robot.example", "https://robot.example"));
    EXPECT_FALSE(is_own_origin(kNetwork, "192.0.2.7:8080", "http://robot.example"));
}

TEST(PageDoor, no_other_page_may_frame_it_or_add_a_script) {
    const std::string policy = header("localhost:8080", "Content-Security-Policy");
    EXPECT_NE(policy.find("default-src 'none'"), std::string::npos);
    EXPECT_NE(policy.find("frame-ancestors 'none'"), std::string::npos);
    EXPECT_NE(policy.find("script-src 'self';"), std::string::npos);
    EXPECT_EQ(policy.find("unsafe"), std::string::npos);
    EXPECT_NE(policy.find("connect-src 'self' ws://localhost:* wss://localhost:*;"),
              std::string::npos);
    EXPECT_EQ(header("localhost:8080", "X-Frame-Options"), "DENY");
    EXPECT_EQ(header("", "X-Content-Type-Options"), "nosniff");
    EXPECT_NE(header("", "Content-Security-Policy").find("frame-ancestors 'none'"),
              std::string::npos);
    EXPECT_EQ(header("", "Referrer-Policy"), "no-referrer");
}

// The fake service in the browser tests reads the same file.
TEST(PageDoor, its_headers_are_those_of_the_contract) {
    std::ifstream file(std::string(SUREFOOT_SOURCE_DIR) + "/service/page/messages.json");
    auto contract = nlohmann::json::parse(file)["http_headers"];
    contract.erase("about");
    const auto headers = security_headers("robot.local:8080");
    EXPECT_EQ(contract.size(), headers.size());
    for (const auto& [name, value] : headers) {
        std::string expected = contract.at(std::string(name));
        for (std::size_t at = 0; (at = expected.find("HOST", at)) != std::string::npos;)
            expected.replace(at, 4, "robot.local");
        EXPECT_EQ(value, expected) << name;
    }
}

// An attacker's text in the Host header must not become part of the policy.
TEST(PageDoor, a_strangers_words_never_reach_the_policy) {
    const std::string policy = header("a; script-src 'unsafe-inline'", "Content-Security-Policy");
    EXPECT_EQ(policy.find("unsafe"), std::string::npos);
    EXPECT_NE(policy.find("connect-src 'none'"), std::string::npos);
}

TEST(PageDoor, a_wrong_name_is_told_the_right_one) {
    EXPECT_NE(wrong_host_text(kLocal).find("http://localhost:8080/"), std::string::npos);
    EXPECT_NE(wrong_host_text(kNetwork).find("http://ADDRESS:8080/"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::page
