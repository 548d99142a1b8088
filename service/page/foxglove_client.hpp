// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "service/gate_process/sockets/token_bucket.hpp"
#include "service/page/foxglove_messages.hpp"
#include "service/page/foxglove_show.hpp"
#include "service/page/gate_listener.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::page {

/// A message of a WebSocket.
struct SocketMessage {
    bool is_text = false;
    std::string bytes;
};

/// Serves one client of the Foxglove WebSocket protocol: reads the messages of the client and
/// chooses the messages to send. This class has no socket, no thread and no clock. The caller
/// passes the time `now_ns` of the steady clock.
///
/// The client gets the newest message of each subscribed channel (of `verdict` each new message),
/// and the time of the source with each frame. Ground, points and images wait while all messages
/// together exceed 2 MB/s. The channel that waited longest goes first. Not thread-safe.
class FoxgloveClient {
  public:
    static constexpr std::int64_t kMostBytesPerSecond = 2'000'000;
    static constexpr std::int64_t kGroundEvery_ns = 500'000'000;
    static constexpr std::int64_t kPointsEvery_ns = 1'000'000'000;
    static constexpr std::int64_t kCameraEvery_ns = 200'000'000;

    /// Queues the two messages that the service sends first: serverInfo and advertise. `session`:
    /// see foxglove_server_info().
    FoxgloveClient(const std::string& name, const std::string& session);

    /// Reads one message of the client. A request that the service cannot serve is answered with a
    /// status message. Returns an error if the client sent too many unreadable texts, or too many
    /// requests before it received the replies. Then the caller must close the connection with
    /// the text of the error as the reason.
    [[nodiscard]] Status take(bool is_text, std::string_view bytes, std::int64_t now_ns);
    /// Returns the messages to send now, in order. Call it only after all earlier messages have
    /// left: a slow client then gets fewer messages, but never an old one.
    [[nodiscard]] std::vector<SocketMessage> next(FoxgloveShow& show, std::int64_t now_ns);

    [[nodiscard]] bool listens_to(FoxgloveChannel channel) const { return of(channel).has_value(); }
    /// Returns the topics of the gate that this client needs.
    [[nodiscard]] GateTopics gate_topics() const {
        return {listens_to(FoxgloveChannel::verdict), listens_to(FoxgloveChannel::outlook)};
    }

  private:
    struct Subscription {
        std::uint32_t id = 0;                 ///< id that the client chose
        std::optional<std::uint64_t> seen;    ///< serial of the last sent message
        std::optional<std::int64_t> sent_ns;  ///< time at which the last message was sent
    };
    using Slot = std::optional<Subscription>;

    [[nodiscard]] const Slot& of(FoxgloveChannel channel) const {
        return subscriptions_[static_cast<std::size_t>(channel)];
    }
    [[nodiscard]] Slot& of(FoxgloveChannel channel) {
        return subscriptions_[static_cast<std::size_t>(channel)];
    }
    [[nodiscard]] Slot* find(std::uint32_t id);
    void take(const FoxgloveSubscribe& request);
    void take(const FoxgloveUnsubscribe& request);
    void take(const FoxgloveUnserved& request);
    /// Adds one subscription, or returns the reason why that is not possible.
    [[nodiscard]] std::optional<std::string> subscribe(FoxgloveSubscribe::Wish wish);
    void say(FoxgloveLevel level, const std::string& sentence);

    void send_time(FoxgloveShow& show, std::vector<SocketMessage>& out);
    void send_verdicts(const FoxgloveShow& show, std::vector<SocketMessage>& out);
    void send_newest(FoxgloveShow& show,
                     FoxgloveChannel channel,
                     std::int64_t now_ns,
                     std::vector<SocketMessage>& out);
    [[nodiscard]] std::optional<FoxgloveChannel> large_one_due(const FoxgloveShow& show,
                                                               std::int64_t now_ns) const;

    std::array<Slot, kFoxgloveChannelCount> subscriptions_;
    std::vector<SocketMessage> replies_;
    gate_process::TokenBucket unreadable_;
    std::uint64_t frame_serial_ = 0;
    std::int64_t free_ns_ = 0;  ///< earliest time of the next large message
};

}  // namespace surefoot::page
