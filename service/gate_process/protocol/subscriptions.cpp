// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/protocol/subscriptions.hpp"

#include <algorithm>

namespace surefoot::gate_process {
namespace {

/// `name` is a name of the catalogue, so it needs no escaping.
std::string publish_text(const std::string& name, const std::string& body) {
    return R"({"op":"publish","topic":")" + name + R"(","msg":)" + body + "}";
}

}  // namespace

std::int64_t Subscriptions::Stream::interval_ns() const noexcept {
    std::int64_t shortest_ns = wishes.front().interval_ns;
    for (const auto& wish : wishes) shortest_ns = std::min(shortest_ns, wish.interval_ns);
    return shortest_ns;
}

std::size_t Subscriptions::Stream::queue_length() const noexcept {
    std::size_t longest = 1;
    for (const auto& wish : wishes) longest = std::max(longest, wish.queue_length);
    return longest;
}

void Subscriptions::Stream::send_due(std::int64_t now_ns, std::vector<std::string>& texts) {
    while (!waiting.empty() && (!sent_before || now_ns - last_sent_ns >= interval_ns())) {
        texts.push_back(publish_text(name, *waiting.front()));
        waiting.pop_front();
        sent_before = true;
        last_sent_ns = now_ns;
    }
}

Subscriptions::Stream* Subscriptions::find(Topic topic) noexcept {
    const auto found = std::find_if(
        streams_.begin(), streams_.end(), [&](const Stream& s) { return s.topic == topic; });
    return found == streams_.end() ? nullptr : &*found;
}

bool Subscriptions::wants(Topic topic) const noexcept {
    return std::any_of(
        streams_.begin(), streams_.end(), [&](const Stream& s) { return s.topic == topic; });
}

std::size_t Subscriptions::count() const noexcept {
    std::size_t count = 0;
    for (const auto& stream : streams_) count += stream.wishes.size();
    return count;
}

Status Subscriptions::add(Topic topic, std::string name, SubscriptionWish wish) {
    Stream* stream = find(topic);
    if (stream != nullptr)
        std::erase_if(stream->wishes, [&](const auto& old) { return old.id == wish.id; });
    if (count() >= max_count_)
        return input_error("this client has the largest number of subscriptions (" +
                           std::to_string(max_count_) + "); unsubscribe first");
    if (stream == nullptr) {
        streams_.push_back({.topic = topic, .name = {}, .wishes = {}, .waiting = {}});
        stream = &streams_.back();
    }
    stream->name = std::move(name);
    stream->wishes.push_back(std::move(wish));
    return {};
}

bool Subscriptions::remove(Topic topic, const std::string& id) {
    Stream* stream = find(topic);
    if (stream == nullptr) return false;
    const std::size_t before = stream->wishes.size();
    std::erase_if(stream->wishes, [&](const auto& wish) { return id.empty() || wish.id == id; });
    const bool removed = stream->wishes.size() < before;
    std::erase_if(streams_, [](const Stream& s) { return s.wishes.empty(); });
    return removed;
}

std::vector<std::string> Subscriptions::offer(const TopicMessage& message, std::int64_t now_ns) {
    std::vector<std::string> texts;
    Stream* stream = find(message.topic);
    if (stream == nullptr) return texts;
    stream->waiting.push_back(message.body);
    stream->send_due(now_ns, texts);
    while (stream->waiting.size() > stream->queue_length()) stream->waiting.pop_front();
    return texts;
}

std::vector<std::string> Subscriptions::due(std::int64_t now_ns) {
    std::vector<std::string> texts;
    for (auto& stream : streams_) stream.send_due(now_ns, texts);
    return texts;
}

}  // namespace surefoot::gate_process
