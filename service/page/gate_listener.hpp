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

/// What of the gate's topics somebody listens to.
struct GateTopics {
    bool verdict = false;
    bool outlook = false;
    friend bool operator==(const GateTopics&, const GateTopics&) = default;
};
enum class GateTopic : std::uint8_t { verdict, outlook };

/// The body of a message, JSON on one line.
struct GateNews {
    GateTopic topic = GateTopic::verdict;
    std::string body;
};
/// What a text of the gate publishes of the topics above; nothing for all else that it says.
[[nodiscard]] std::optional<GateNews> read_gate_news(std::string_view text);

/// Where the gate's service is.
struct GateService {
    std::string address;     ///< in numbers
    std::uint16_t port = 0;  ///< 0 = there is none yet
    std::string token;       ///< empty = it wants none
    friend bool operator==(const GateService&, const GateService&) = default;
};

/// Hears what the gate tells everybody: one more client of its rosbridge service, which only
/// listens, and only while somebody wants to hear it. All happens in the thread that runs `io`.
class GateListener {
  public:
    using Sink = std::function<void(GateNews news)>;

    GateListener(boost::asio::io_context& io, Sink sink);
    GateListener(const GateListener&) = delete;
    GateListener& operator=(const GateListener&) = delete;
    ~GateListener();

    /// Call it every few milliseconds. A connection that cannot be made or breaks is tried again
    /// twice a second; without a topic there is none.
    void want(const GateService& service, GateTopics topics, std::int64_t now_ns);

  private:
    class Connection;

    void hang_up();

    boost::asio::io_context& io_;
    Sink sink_;
    GateService service_;
    std::shared_ptr<Connection> connection_;  ///< shared with its own waiting handlers
    std::int64_t retry_ns_ = 0;
};

}  // namespace surefoot::page
