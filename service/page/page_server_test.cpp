// SPDX-License-Identifier: Apache-2.0
#include "service/page/page_server.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <thread>

#include "service/gate_process/sockets/server_config.hpp"

namespace surefoot::page {
namespace {

/// A plain TCP connection to the page.
class Caller {
  public:
    explicit Caller(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(port);
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        EXPECT_EQ(::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    }
    Caller(Caller&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}
    Caller& operator=(Caller&&) = delete;
    ~Caller() {
        if (socket_ >= 0) ::close(socket_);
    }

    void say(const std::string& text) {
        EXPECT_EQ(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL),
                  static_cast<ssize_t>(text.size()));
    }
    /// Receives until the page closes, `end` arrives or `patience_ms` has passed.
    std::string hear(const std::string& end = "", int patience_ms = 20'000) {
        std::string heard;
        std::array<char, 4096> bytes{};
        pollfd wait{socket_, POLLIN, 0};
        while ((end.empty() || heard.find(end) == std::string::npos) &&
               ::poll(&wait, 1, patience_ms) > 0) {
            const ssize_t got = ::recv(socket_, bytes.data(), bytes.size(), 0);
            if (got <= 0) {
                closed_ = true;
                break;
            }
            heard.append(bytes.data(), static_cast<std::size_t>(got));
        }
        return heard;
    }
    [[nodiscard]] bool is_closed() const { return closed_; }

  private:
    int socket_;
    bool closed_ = false;
};

class PageServerTest : public ::testing::Test {
  protected:
    void serve(PageServerConfig config = {}) {
        config.port = 0;
        auto server = PageServer::open(config, feed_, controls_);
        ASSERT_TRUE(server.ok()) << server.error().message;
        server_ = std::move(*server);
        thread_ = std::thread([this] { server_->run(); });
    }
    ~PageServerTest() override {
        if (!thread_.joinable()) return;
        server_->stop();
        thread_.join();
    }
    [[nodiscard]] std::string own_host() const {
        return "127.0.0.1:" + std::to_string(server_->port());
    }
    std::string ask(const std::string& request) {
        Caller caller(server_->port());
        caller.say(request);
        return caller.hear();
    }
    std::string get(const std::string& path,
                    const std::string& host,
                    const std::string& more = "") {
        return ask("GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\n" + more + "\r\n");
    }
    /// Opens a WebSocket; returns the first line of the response.
    std::string knock(Caller& caller,
                      const std::string& path,
                      const std::string& host,
                      const std::string& more = "") {
        caller.say("GET " + path + " HTTP/1.1\r\nHost: " + host +
                   "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                   "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
                   "Sec-WebSocket-Version: 13\r\n" +
                   more + "\r\n");
        const std::string answer = caller.hear("\r\n\r\n");
        return answer.substr(0, answer.find("\r\n"));
    }
    std::string knock(const std::string& path,
                      const std::string& host,
                      const std::string& more = "") {
        Caller caller(server_->port());
        return knock(caller, path, host, more);
    }
    /// A page that has asked for the map.
    Caller viewer() {
        Caller caller(server_->port());
        EXPECT_NE(knock(caller, "/page", own_host()).find("101"), std::string::npos);
        // {"op":"want"} in a masked frame; the mask is 0.
        caller.say(std::string("\x81\x8d\0\0\0\0", 6) + R"({"op":"want"})");
        return caller;
    }

    PageFeed feed_;
    PageControls controls_;
    std::unique_ptr<PageServer> server_;
    std::thread thread_;
};

const char* const kPolicy = "frame-ancestors 'none'";

TEST_F(PageServerTest, every_answer_says_what_other_pages_may_not_do) {
    serve();
    const std::string host = own_host();
    for (const std::string& answer :
         {get("/", host),
          get("/nowhere", host),
          get("/machine.urdf", host),
          get("/", "evil.example"),
          get("/page", host, "Upgrade: websocket\r\nConnection: Upgrade\r\nOrigin: http://a.b\r\n"),
          ask("POST / HTTP/1.1\r\nHost: " + host + "\r\n\r\n"),
          ask("HEAD / HTTP/1.1\r\nHost: " + host + "\r\n\r\n"),
          ask("this is no request\r\n\r\n"),
          ask("GET / HTTP/1.1\r\n\r\n")}) {
        EXPECT_NE(answer.find(kPolicy), std::string::npos) << answer.substr(0, 300);
        EXPECT_NE(answer.find("X-Frame-Options: DENY"), std::string::npos) << answer.substr(0, 300);
        EXPECT_NE(answer.find("X-Content-Type-Options: nosniff"), std::string::npos);
    }
    Caller caller(server_->port());
    caller.say("GET /page HTTP/1.1\r\nHost: " + host +
               "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: "
               "AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n\r\n");
    EXPECT_NE(caller.hear("\r\n\r\n").find("X-Content-Type-Options: nosniff"), std::string::npos);
}

TEST_F(PageServerTest, a_name_that_was_rebound_gets_no_file_and_no_socket) {
    serve();
    const std::string port = ":" + std::to_string(server_->port());
    for (const char* path : {"/", "/index.html", "/machine.urdf", "/nowhere"}) {
        EXPECT_NE(get(path, "evil.example" + port).find("HTTP/1.1 421"), std::string::npos) << path;
        EXPECT_EQ(get(path, own_host()).find("HTTP/1.1 421"), std::string::npos) << path;
    }
    for (const char* path : {"/page", "/"}) {
        const std::string foxglove = "Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n";
        EXPECT_NE(knock(path, "evil.example" + port, foxglove).find("421"), std::string::npos);
        EXPECT_NE(knock(path, "localhost:1", foxglove).find("421"), std::string::npos);
        EXPECT_NE(knock(path, own_host(), foxglove).find("101"), std::string::npos) << path;
    }
    EXPECT_NE(
        ask("GET / HTTP/1.1\r\nHost: " + own_host() + "\r\nHost: evil.example\r\n\r\n").find("400"),
        std::string::npos);
    EXPECT_NE(get("http://evil.example/", own_host()).find("HTTP/1.1 400"), std::string::npos);
}

TEST_F(PageServerTest, only_the_page_itself_may_open_its_socket) {
    PageServerConfig config;
    config.foxglove_origins = {"https://app.foxglove.dev"};
    serve(config);
    const std::string port = std::to_string(server_->port());
    const auto from = [&](const std::string& origin, const std::string& more = "") {
        return knock("/page", own_host(), "Origin: " + origin + "\r\n" + more);
    };
    EXPECT_NE(from("http://127.0.0.1:" + port).find("101"), std::string::npos);
    EXPECT_NE(from("http://localhost:" + port).find("101"), std::string::npos);
    for (const char* stranger : {"http://127.0.0.1:1",
                                 "http://localhost",
                                 "http://evil.example",
                                 "null",
                                 "file://",
                                 "https://app.foxglove.dev"})
        EXPECT_NE(from(stranger).find("403"), std::string::npos) << stranger;
    const std::string foxglove = "Sec-WebSocket-Protocol: foxglove.sdk.v1\r\nOrigin: ";
    EXPECT_NE(knock("/", own_host(), foxglove + "https://app.foxglove.dev\r\n").find("101"),
              std::string::npos);
    EXPECT_NE(knock("/", own_host(), foxglove + "http://localhost:3000\r\n").find("403"),
              std::string::npos);
}

// 300 connections that send nothing, or never end their request: the next visitor gets the page.
TEST_F(PageServerTest, half_open_requests_keep_nobody_out) {
    serve();
    std::vector<Caller> crowd;
    for (int i = 0; i < 300; ++i) {
        crowd.emplace_back(server_->port());
        if (i % 2 == 0) crowd.back().say("GET / HTTP/1.1\r\nHost: ");
    }
    for (int i = 0; i < 5; ++i)
        EXPECT_NE(get("/nowhere", own_host()).find("HTTP/1.1 404"), std::string::npos);
    Caller page = viewer();
    EXPECT_NE(page.hear("status").find("status"), std::string::npos);
}

TEST_F(PageServerTest, a_request_that_does_not_end_is_ended) {
    PageServerConfig config;
    config.header_ms = 200;
    serve(config);
    Caller slow(server_->port());
    const auto begin = std::chrono::steady_clock::now();
    slow.say("GET / HTTP/1.1\r\n");
    EXPECT_EQ(slow.hear(), "");
    EXPECT_TRUE(slow.is_closed());
    EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(150));
}

TEST_F(PageServerTest, sockets_that_never_ask_give_way_to_pages) {
    PageServerConfig config;
    config.slots.max_clients = 3;
    serve(config);
    std::vector<Caller> sleepers;
    for (int i = 0; i < 3; ++i) {
        sleepers.emplace_back(server_->port());
        EXPECT_NE(knock(sleepers.back(), "/page", own_host()).find("101"), std::string::npos);
    }
    std::vector<Caller> pages;
    for (int i = 0; i < 3; ++i) pages.push_back(viewer());
    for (Caller& sleeper : sleepers) {
        sleeper.hear();
        EXPECT_TRUE(sleeper.is_closed()) << "it made room";
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_NE(knock("/page", own_host()).find("503"), std::string::npos)
        << "pages that look stay where they are";
    for (Caller& page : pages) {
        page.hear("status", 2'000);
        EXPECT_FALSE(page.is_closed());
    }
}

TEST(PageServerConfig, OutsideNeedsATokenAndTlsOrTheSentence) {
    PageServerConfig config;
    EXPECT_EQ(config.problem(), nullptr);
    config.bind_address = "0.0.0.0";
    EXPECT_NE(std::string(config.problem()).find("--token-file"), std::string::npos);
    config.token = "secret";
    EXPECT_NE(std::string(config.problem()).find("--certificate"), std::string::npos);
    config.insecure = "yes";
    EXPECT_NE(config.problem(), nullptr);
    config.insecure = gate_process::kInsecureSentence;
    EXPECT_EQ(config.problem(), nullptr);
    config.insecure.clear();
    config.tls = {"certificate.pem", ""};
    EXPECT_NE(std::string(config.problem()).find("both files"), std::string::npos);
    config.tls.key_file = "key.pem";
    EXPECT_EQ(config.problem(), nullptr);
}

}  // namespace
}  // namespace surefoot::page
