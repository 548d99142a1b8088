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

/// One client of the Foxglove WebSocket protocol, as texts in and messages out: no socket, no
/// thread, no clock. It gets what it subscribed to, the newest of each channel, and with each frame
/// the source's time. Ground and images come as often as 2 MB a second allow at most, the one that
/// waited longest first.
class FoxgloveClient {
  public:
    static constexpr std::int64_t kMostBytesPerSecond = 2'000'000;
    static constexpr std::int64_t kGroundEvery_ns = 500'000'000;
    static constexpr std::int64_t kPointsEvery_ns = 1'000'000'000;
    static constexpr std::int64_t kCameraEvery_ns = 200'000'000;

    /// The service introduces itself first. `session`: see foxglove_server_info.
    FoxgloveClient(const std::string& name, const std::string& session);

    /// What the client sent. Whatever cannot be met is answered by a status; an error is the
    /// sentence to let it go with.
    [[nodiscard]] Status take(bool is_text, std::string_view bytes, std::int64_t now_ns);
    /// What leaves now. Only when all that left before has gone: so a slow client is sent less
    /// often, never what is old.
    [[nodiscard]] std::vector<SocketMessage> next(FoxgloveShow& show, std::int64_t now_ns);

    [[nodiscard]] bool listens_to(FoxgloveChannel channel) const { return of(channel).has_value(); }
    [[nodiscard]] GateTopics gate_topics() const {
        return {listens_to(FoxgloveChannel::verdict), listens_to(FoxgloveChannel::outlook)};
    }

  private:
    struct Subscription {
        std::uint32_t id = 0;                 ///< the client's number for it
        std::optional<std::uint64_t> seen;    ///< serial of what it was sent last
        std::optional<std::int64_t> sent_ns;  ///< when
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
    /// The first reason against a wish, or nothing.
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
    wire::TokenBucket unreadable_;
    std::uint64_t frame_serial_ = 0;
    std::int64_t free_ns_ = 0;  ///< from then on there is room for something large
};

}  // namespace surefoot::page
