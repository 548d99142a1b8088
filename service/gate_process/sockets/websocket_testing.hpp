// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <utility>

#include "service/gate_process/protocol/json_text.hpp"
#include "service/gate_process/sockets/websocket_server.hpp"
#include "service/gate_process/wire_testing.hpp"

/// Shared by the tests of the service over real sockets of this machine: a server on its own thread
/// and its clients. No result depends on a clock: clients wait for the expected messages, and the
/// deadlines of the server are short.
namespace surefoot::gate_process::testing {

namespace beast = boost::beast;
namespace http = beast::http;
namespace net = boost::asio;
namespace websocket = beast::websocket;
using beast::error_code;
using tcp = net::ip::tcp;

inline const std::string kToken = testing::three_tokens().operator_;
inline const std::string kRider = testing::three_tokens().rider;

inline ServerConfig any_port() {
    ServerConfig config;
    config.port = 0;
    return config;
}

/// A server on its own thread; its gate can be examined after it has ended.
class Service {
  public:
    explicit Service(const ServerConfig& config = any_port())
        : server_(std::move(
              WebsocketServer::open(config, gate, [this](std::int64_t) { look(); }).value())),
          thread_([this] { server_->run(); }) {}
    Service(const Service&) = delete;
    Service& operator=(const Service&) = delete;
    ~Service() { end(); }

    void end() {
        if (!thread_.joinable()) return;
        server_->stop();
        thread_.join();
        look();
    }
    [[nodiscard]] tcp::endpoint endpoint() const {
        return {net::ip::make_address("127.0.0.1"), server_->port()};
    }
    /// The counts at the last tick.
    [[nodiscard]] ServerCounts counts() {
        const std::lock_guard lock(mutex_);
        return counts_;
    }
    /// Waits for this many accepted connections, no pending ones, and this many clients.
    void wait_for(std::uint64_t accepted, std::size_t clients) {
        for (ServerCounts now = counts();
             now.accepted != accepted || now.clients != clients || now.handshakes != 0;
             now = counts())
            std::this_thread::yield();
    }

    ScriptedGate gate;
    std::atomic<int> ticks = 0;

  private:
    void look() {
        ++ticks;
        const std::lock_guard lock(mutex_);
        counts_ = server_->counts();
    }

    std::mutex mutex_;
    ServerCounts counts_;
    std::unique_ptr<WebsocketServer> server_;
    std::thread thread_;
};

/// A client that follows the protocol until it writes to the bare socket.
class Client {
  public:
    explicit Client(const Service& service) { socket().connect(service.endpoint()); }
    explicit Client(const Service& service, const std::string& target, const std::string& origin)
        : Client(service) {
        open(target, origin);
    }

    void open(const std::string& target = "/", const std::string& origin = "") {
        ws_.set_option(websocket::stream_base::decorator([&](websocket::request_type& request) {
            if (!origin.empty()) request.set(http::field::origin, origin);
            if (!authorization_.empty()) request.set(http::field::authorization, authorization_);
        }));
        ws_.handshake("127.0.0.1", target);
    }
    /// Call it before `open`.
    void authorize(const std::string& header) { authorization_ = header; }
    void send(const std::string& text) { ws_.write(net::buffer(text)); }
    Json receive() {
        beast::flat_buffer buffer;
        ws_.read(buffer);
        return Json::parse(beast::buffers_to_string(buffer.data()));
    }
    Json ask(const std::string& text) {
        send(text);
        return receive();
    }
    /// Reads until the connection ends. Returns the close code, or 0.
    int end_of_reading() {
        error_code error;
        while (!error) {
            beast::flat_buffer buffer;
            ws_.read(buffer, error);
        }
        return error == websocket::error::closed ? ws_.reason().code : 0;
    }
    /// The close code, even if the server did not wait for the client's close frame.
    int goodbye() {
        (void)end_of_reading();
        return ws_.reason().code;
    }
    void send_bytes(const std::string& bytes) {
        error_code ignored;
        net::write(socket(), net::buffer(bytes), ignored);
    }
    /// Reads everything that still arrives, without answering.
    std::string read_bytes() {
        std::string bytes;
        error_code error;
        net::read(socket(), net::dynamic_buffer(bytes), error);
        return bytes;
    }
    tcp::socket& socket() { return ws_.next_layer(); }
    websocket::stream<tcp::socket>& ws() { return ws_; }

  private:
    net::io_context io_;
    std::string authorization_;
    websocket::stream<tcp::socket> ws_{io_};
};

inline const char* const kStep = R"({"op":"call_service","id":"q","service":"/step","args":[9]})";

inline void expect_allowed(Client& client) {
    const Json response = client.ask(kStep);
    EXPECT_EQ(response["values"]["resultCode"], 0) << response;
}

inline http::response<http::string_body> answer_to(const Service& service,
                                                   const http::request<http::empty_body>& request) {
    net::io_context io;
    tcp::socket socket(io);
    socket.connect(service.endpoint());
    http::write(socket, request);
    beast::flat_buffer buffer;
    http::response_parser<http::string_body> parser;
    parser.skip(request.find(http::field::upgrade) != request.end());
    http::read(socket, buffer, parser);
    return parser.release();
}

inline http::response<http::string_body> get(const Service& service,
                                             const std::string& target,
                                             http::verb verb = http::verb::get) {
    return answer_to(service, {verb, target, 11});
}

/// The HTTP status; 101 if a WebSocket opens.
inline unsigned status_of_upgrade(const Service& service,
                                  const std::string& target,
                                  const std::string& origin = "") {
    http::request<http::empty_body> request(http::verb::get, target, 11);
    request.set(http::field::host, "127.0.0.1");
    request.set(http::field::connection, "Upgrade");
    request.set(http::field::upgrade, "websocket");
    request.set(http::field::sec_websocket_version, "13");
    request.set(http::field::sec_websocket_key, "MDEyMzQ1Njc4OWFiY2RlZg==");
    if (!origin.empty()) request.set(http::field::origin, origin);
    return answer_to(service, request).result_int();
}

}  // namespace surefoot::gate_process::testing
