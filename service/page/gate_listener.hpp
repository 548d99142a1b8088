// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace boost::asio {
class io_context;
}

namespace surefoot::page {

/// The topics of the gate that at least one client wants.
struct GateTopics {
    bool verdict = false;
    bool outlook = false;
    friend bool operator==(const GateTopics&, const GateTopics&) = default;
};
enum class GateTopic : std::uint8_t { verdict, outlook };

/// One message that the gate published; `body` is JSON on one line.
struct GateNews {
    GateTopic topic = GateTopic::verdict;
    std::string body;
};
/// Reads one text of the gate (rosbridge protocol). Returns empty unless the text publishes a topic
/// of GateTopic.
[[nodiscard]] std::optional<GateNews> read_gate_news(std::string_view text);

/// Address of the gate's rosbridge service.
struct GateService {
    std::string address;     ///< numeric IP address; 0.0.0.0 and :: mean this machine
    std::uint16_t port = 0;  ///< TCP port; 0 = not known yet
    std::string token;       ///< empty = the gate needs no token
    friend bool operator==(const GateService&, const GateService&) = default;
};

/// Subscribes to the gate's public topics as one more client of its rosbridge service. The listener
/// asks the gate no question. It is connected only while a client wants a topic. All work happens
/// on the thread that runs `io`; `want` must be called on that thread.
class GateListener {
  public:
    using Sink = std::function<void(GateNews news)>;

    GateListener(boost::asio::io_context& io, Sink sink);
    GateListener(const GateListener&) = delete;
    GateListener& operator=(const GateListener&) = delete;
    ~GateListener();

    /// Sets the wanted topics. Call it every few milliseconds: a connection that failed or broke is
    /// tried again at most twice a second. Without a wanted topic, or with port 0, the connection
    /// is closed.
    void want(const GateService& service, GateTopics topics, std::int64_t now_ns);

  private:
    class Connection;

    void hang_up();

    boost::asio::io_context& io_;
    Sink sink_;
    GateService service_;
    std::shared_ptr<Connection> connection_;  ///< shared with its pending handlers
    std::int64_t retry_ns_ = 0;
};

}  // namespace surefoot::page
