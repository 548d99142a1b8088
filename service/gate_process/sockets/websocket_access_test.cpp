// SPDX-License-Identifier: Apache-2.0
// Who may connect, and with which rights.
#include <gtest/gtest.h>

#include <boost/beast/http.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "service/gate_process/protocol/json_text.hpp"
#include "service/gate_process/sockets/websocket_server.hpp"
#include "service/gate_process/sockets/websocket_testing.hpp"
#include "service/gate_process/wire_testing.hpp"

namespace surefoot::gate_process::testing {
namespace {

TEST(WebsocketServer, DoesNotListenOutsideWithoutATokenAndTls) {
    ScriptedGate gate;
    ServerConfig config = any_port();
    config.bind_address = "0.0.0.0";
    EXPECT_FALSE(WebsocketServer::open(config, gate));
    config.access = testing::three_tokens(Role::none);
    EXPECT_FALSE(WebsocketServer::open(config, gate));
    config.insecure = kInsecureSentence;
    EXPECT_TRUE(WebsocketServer::open(config, gate));
}

TEST(WebsocketServer, TheTokenOpensTheDoor) {
    ServerConfig config = any_port();
    config.access = testing::three_tokens(Role::none);
    Service service(config);
    EXPECT_EQ(status_of_upgrade(service, "/"), 401U);
    EXPECT_EQ(status_of_upgrade(service, "/?token=operator-token-of-testt"), 401U);
    EXPECT_EQ(get(service, "/health").result_int(), 401U);
    EXPECT_EQ(get(service, "/health?token=" + kToken).result_int(), 200U);
    Client client(service, "/?token=" + kToken, "");
    expect_allowed(client);
}

TEST(WebsocketServer, PagesOfOthersStayOutside) {
    ServerConfig config = any_port();
    config.origins = {"https://clinic.example"};
    Service service(config);
    EXPECT_EQ(status_of_upgrade(service, "/", "http://evil.example"), 403U);
    EXPECT_EQ(status_of_upgrade(service, "/", "null"), 403U);
    EXPECT_EQ(status_of_upgrade(service, "/", "http://localhost:8080"), 101U);
    EXPECT_EQ(status_of_upgrade(service, "/", "https://clinic.example"), 101U);
}

Json call(Client& client, const std::string& service, const std::string& args = "[]") {
    return client.ask(R"({"op":"call_service","id":"c","service":")" + service + R"(","args":)" +
                      args + "}")["values"];
}

TEST(WebsocketServer, TheRoleComesWithTheConnection) {
    ServerConfig config = any_port();
    config.access = testing::three_tokens();
    Service service(config);
    Client guest(service, "/", "");
    EXPECT_EQ(call(guest, "/surefoot/attest", "[0.4]")["success"], false);
    Client observer(service, "/?token=" + testing::three_tokens().observer, "");
    EXPECT_EQ(observer.ask(kStep)["result"], false);
    Client by_url(service, "/?token=" + kToken, "");
    EXPECT_EQ(call(by_url, "/surefoot/attest", "[0.4]")["success"], true);
    Client by_header(service);
    by_header.authorize("Bearer " + kToken);
    by_header.open();
    EXPECT_EQ(call(by_header, "/surefoot/rearm")["success"], true);
    EXPECT_EQ(call(guest, "/surefoot/authenticate", R"({"token":")" + kToken + "\"}")["role"],
              "operator");
    EXPECT_EQ(call(guest, "/surefoot/attest", "[0.4]")["success"], true);
    service.end();
    const auto acts_of = [&](std::uint64_t connection) {
        std::string text;
        for (const Act& act : service.gate.acts) {
            if (act.connection == connection)
                text += std::string(to_string(act.role)) + " " + to_string(act.kind) + " " +
                        to_string(act.outcome) + ";";
        }
        return text;
    };
    EXPECT_EQ(acts_of(1), "rider attest no right;operator authenticate done;operator attest done;");
    EXPECT_EQ(acts_of(2), "observer authenticate done;observer ask no right;");
    EXPECT_EQ(acts_of(3), "operator authenticate done;operator attest done;");
    EXPECT_EQ(acts_of(4), "operator authenticate done;operator re-arm done;");
}

TEST(WebsocketServer, WhoeverIsRefusedAtTheDoorIsToldWhyAndNoted) {
    ServerConfig config = any_port();
    config.access = testing::three_tokens(Role::none);
    Service service(config);
    const auto wrong = get(service, "/health?token=0123456789abcdef");
    EXPECT_EQ(wrong.result_int(), 401U);
    EXPECT_NE(wrong.body().find("this token is not known"), std::string::npos) << wrong.body();
    const auto none = get(service, "/health");
    EXPECT_EQ(none.result_int(), 401U);
    EXPECT_NE(none.body().find("a token is needed"), std::string::npos) << none.body();
    http::request<http::empty_body> page(http::verb::get, "/health?token=" + kToken, 11);
    page.set(http::field::origin, "null");
    const auto origin = answer_to(service, page);
    EXPECT_EQ(origin.result_int(), 403U);
    EXPECT_NE(origin.body().find("--origin 'null'"), std::string::npos) << origin.body();
    service.end();
    ASSERT_EQ(service.gate.acts.size(), 3U);
    EXPECT_EQ(service.gate.acts[0].kind, ActKind::authenticate);
    EXPECT_EQ(service.gate.acts[1].kind, ActKind::connect);
    EXPECT_EQ(service.gate.acts[2].text, "from this computer, a web page of another origin");
    for (const Act& act : service.gate.acts) EXPECT_EQ(act.outcome, ActOutcome::no_right);
}

}  // namespace
}  // namespace surefoot::gate_process::testing
