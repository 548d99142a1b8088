// SPDX-License-Identifier: Apache-2.0
#include "service/page/foxglove_client.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "surefoot/core/time.hpp"

namespace surefoot::page {
namespace {

/// Rate limit of unreadable texts. A client of another version may send a few; a client that sends
/// more is disconnected.
constexpr gate_process::RateLimit kUnreadable{1, 8};
constexpr std::size_t kMostReplies = 64;

struct Large {
    FoxgloveChannel channel;
    std::int64_t every_ns;
};
constexpr std::array kLarge{
    Large{FoxgloveChannel::camera, FoxgloveClient::kCameraEvery_ns},
    Large{FoxgloveChannel::ground, FoxgloveClient::kGroundEvery_ns},
    Large{FoxgloveChannel::ground_points, FoxgloveClient::kPointsEvery_ns},
};
constexpr std::array kSmall{FoxgloveChannel::transforms,
                            FoxgloveChannel::pose,
                            FoxgloveChannel::status,
                            FoxgloveChannel::outlook};

}  // namespace

FoxgloveClient::FoxgloveClient(const std::string& name, const std::string& session)
    : unreadable_(kUnreadable) {
    replies_.push_back({true, foxglove_server_info(name, session)});
    replies_.push_back({true, foxglove_advertise()});
}

void FoxgloveClient::say(FoxgloveLevel level, const std::string& sentence) {
    replies_.push_back({true, foxglove_status(level, sentence)});
}

Status FoxgloveClient::take(bool is_text, std::string_view bytes, std::int64_t now_ns) {
    if (replies_.size() >= kMostReplies)
        return input_error(
            "the client sends requests but does not read the replies; read each reply");
    if (!is_text) {
        say(FoxgloveLevel::warning, "a client cannot send binary messages; send text");
        return {};
    }
    const auto request = parse_foxglove_request(bytes);
    if (!request) {
        say(FoxgloveLevel::error, request.error().message);
        if (unreadable_.take(now_ns)) return {};
        return input_error("too many unreadable messages; the last problem: " +
                           request.error().message);
    }
    std::visit([this](const auto& what) { take(what); }, *request);
    return {};
}

FoxgloveClient::Slot* FoxgloveClient::find(std::uint32_t id) {
    const auto found = std::find_if(subscriptions_.begin(),
                                    subscriptions_.end(),
                                    [&](const Slot& slot) { return slot && slot->id == id; });
    return found == subscriptions_.end() ? nullptr : &*found;
}

std::optional<std::string> FoxgloveClient::subscribe(FoxgloveSubscribe::Wish wish) {
    if (wish.channel == 0 || wish.channel > kFoxgloveChannelCount)
        return fmt::format(
            "subscribe: there is no channel {}; use a channel id of the advertise message",
            wish.channel);
    if (find(wish.subscription) != nullptr)
        return fmt::format("subscribe: subscription {} already exists; use another id",
                           wish.subscription);
    Slot& slot = subscriptions_[wish.channel - 1];
    if (slot)
        return fmt::format(
            "subscribe: this client already has a subscription to channel {}, with the id {}",
            wish.channel,
            slot->id);
    slot = Subscription{wish.subscription, {}, {}};
    return std::nullopt;
}

// Sends one status message for a request, even if its list has several problems.
void FoxgloveClient::take(const FoxgloveSubscribe& request) {
    std::optional<std::string> first_problem;
    for (const FoxgloveSubscribe::Wish wish : request.wishes) {
        auto problem = subscribe(wish);
        if (!first_problem) first_problem = std::move(problem);
    }
    if (first_problem) say(FoxgloveLevel::warning, *first_problem);
}

void FoxgloveClient::take(const FoxgloveUnsubscribe& request) {
    std::optional<std::uint32_t> unknown;
    for (const std::uint32_t id : request.subscriptions) {
        Slot* const slot = find(id);
        if (slot != nullptr) slot->reset();
        if (slot == nullptr && !unknown) unknown = id;
    }
    if (unknown)
        say(FoxgloveLevel::warning,
            fmt::format("unsubscribe: this client has no subscription {}", *unknown));
}

void FoxgloveClient::take(const FoxgloveUnserved& request) {
    say(FoxgloveLevel::warning,
        fmt::format("{}: this operation is not supported; use subscribe or unsubscribe",
                    request.operation));
}

void FoxgloveClient::send_time(FoxgloveShow& show, std::vector<SocketMessage>& out) {
    if (show.frame_serial() == frame_serial_) return;
    frame_serial_ = show.frame_serial();
    out.push_back({false, foxglove_time(show.now_ns())});
}

void FoxgloveClient::send_newest(FoxgloveShow& show,
                                 FoxgloveChannel channel,
                                 std::int64_t now_ns,
                                 std::vector<SocketMessage>& out) {
    Slot& slot = of(channel);
    const std::uint64_t serial = show.serial(channel);
    if (!slot || serial == 0 || slot->seen == serial) return;
    slot->seen = serial;
    slot->sent_ns = now_ns;
    const std::string& payload = show.payload(channel);
    if (payload.empty()) return;
    out.push_back({false, foxglove_message(slot->id, show.time_ns(channel), payload)});
}

void FoxgloveClient::send_verdicts(const FoxgloveShow& show, std::vector<SocketMessage>& out) {
    Slot& slot = of(FoxgloveChannel::verdict);
    if (!slot) return;
    const std::uint64_t newest = show.verdicts().empty() ? 0 : show.verdicts().back().serial;
    // A new subscriber gets no earlier verdicts.
    const std::uint64_t seen = slot->seen.value_or(newest);
    slot->seen = newest;
    for (const FoxgloveShow::Verdict& verdict : show.verdicts()) {
        if (verdict.serial > seen)
            out.push_back({false, foxglove_message(slot->id, verdict.time_ns, verdict.payload)});
    }
}

std::optional<FoxgloveChannel> FoxgloveClient::large_one_due(const FoxgloveShow& show,
                                                             std::int64_t now_ns) const {
    if (now_ns < free_ns_) return std::nullopt;
    std::optional<FoxgloveChannel> first;
    std::optional<std::int64_t> first_sent_ns;
    for (const Large& large : kLarge) {
        const Slot& slot = of(large.channel);
        const std::uint64_t serial = show.serial(large.channel);
        if (!slot || serial == 0 || slot->seen == serial) continue;
        if (slot->sent_ns && now_ns - *slot->sent_ns < large.every_ns) continue;
        // An empty optional is less than any time, so a channel without an earlier message comes
        // first.
        if (first && first_sent_ns <= slot->sent_ns) continue;
        first = large.channel;
        first_sent_ns = slot->sent_ns;
    }
    return first;
}

std::vector<SocketMessage> FoxgloveClient::next(FoxgloveShow& show, std::int64_t now_ns) {
    std::vector<SocketMessage> out = std::exchange(replies_, {});
    send_time(show, out);
    for (const FoxgloveChannel channel : kSmall) send_newest(show, channel, now_ns, out);
    send_verdicts(show, out);
    if (const auto large = large_one_due(show, now_ns)) send_newest(show, *large, now_ns, out);
    std::int64_t bytes = 0;
    for (const SocketMessage& message : out) bytes += std::ssize(message.bytes);
    free_ns_ = std::max(free_ns_, now_ns) + bytes * (kNanosecondsPerSecond / kMostBytesPerSecond);
    return out;
}

}  // namespace surefoot::page
