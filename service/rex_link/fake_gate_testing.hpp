// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace surefoot::rex_link {

/// The fake gate's reaction to one question.
struct Reply {
    std::vector<std::string> texts;  ///< sent one after the other; empty = silence
    bool binary = false;
    bool hang_up = false;  ///< closes the connection after the texts
};

/// A rosbridge server on loopback that serves one client at a time, on its own thread, and replies
/// as the test specifies. The destructor ends it; the client must have disconnected before.
class FakeGate {
  public:
    using Script = std::function<Reply(const std::string& question, int count)>;

    explicit FakeGate(Script script)
        : script_(std::move(script)),
          acceptor_(io_, {boost::asio::ip::make_address("127.0.0.1"), 0}),
          port_(acceptor_.local_endpoint().port()),
          thread_([this] { serve(); }) {}
    FakeGate(const FakeGate&) = delete;
    FakeGate& operator=(const FakeGate&) = delete;
    ~FakeGate() {
        stopping_ = true;
        boost::system::error_code ignored;
        boost::asio::ip::tcp::socket nudge(io_);  // wakes the acceptor
        nudge.connect({boost::asio::ip::make_address("127.0.0.1"), port_}, ignored);
        nudge.close(ignored);
        thread_.join();
    }

    [[nodiscard]] std::uint16_t port() const noexcept { return port_; }

  private:
    void serve() {
        while (true) {
            boost::system::error_code error;
            boost::asio::ip::tcp::socket socket(io_);
            acceptor_.accept(socket, error);
            if (stopping_) return;
            if (!error) serve_client(std::move(socket));
        }
    }
    void serve_client(boost::asio::ip::tcp::socket socket) {
        namespace beast = boost::beast;
        boost::system::error_code error;
        socket.set_option(boost::asio::ip::tcp::no_delay(true), error);
        beast::websocket::stream<boost::asio::ip::tcp::socket> stream(std::move(socket));
        stream.accept(error);
        while (!error) {
            beast::flat_buffer buffer;
            stream.read(buffer, error);
            if (error) return;
            const Reply reply = script_(beast::buffers_to_string(buffer.data()), ++count_);
            stream.binary(reply.binary);
            for (const std::string& text : reply.texts)
                stream.write(boost::asio::buffer(text), error);
            if (reply.hang_up) return;
        }
    }

    Script script_;
    int count_ = 0;
    std::atomic<bool> stopping_{false};
    boost::asio::io_context io_;
    boost::asio::ip::tcp::acceptor acceptor_;
    std::uint16_t port_;
    std::thread thread_;
};

}  // namespace surefoot::rex_link
