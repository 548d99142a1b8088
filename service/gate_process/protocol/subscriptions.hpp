// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "service/gate_process/protocol/catalogue.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::gate_process {

/// A message of a topic. All connections in which the message waits share the JSON of its body.
struct TopicMessage {
    Topic topic = Topic::health;
    std::shared_ptr<const std::string> body;
};

/// A subscription of a client to a topic. `interval_ns`: throttle_rate of rosbridge (ms there).
/// `queue_length`: number of messages that are kept during the interval.
struct SubscriptionWish {
    std::string id;  ///< id of the subscription; may be empty
    std::int64_t interval_ns = 0;
    std::size_t queue_length = 0;
};

/// The subscriptions of one connection. Several subscriptions to a topic form one stream, with the
/// shortest interval and the longest queue of these subscriptions. During the interval the newest
/// messages are kept (at least one), so a slow client receives the last state.
class Subscriptions {
  public:
    explicit Subscriptions(std::size_t max_count) : max_count_(max_count) {}

    /// Adds a subscription. `name`: the topic in the client's spelling, which the messages repeat.
    /// It replaces a subscription to the topic with the same id. Error above the limit.
    [[nodiscard]] Status add(Topic topic, std::string name, SubscriptionWish wish);
    /// Removes one subscription, or with an empty id all of the topic. False if there was none.
    bool remove(Topic topic, const std::string& id);
    /// Returns the complete texts to send now; may be empty.
    [[nodiscard]] std::vector<std::string> offer(const TopicMessage& message, std::int64_t now_ns);
    /// Returns the messages whose interval has passed.
    [[nodiscard]] std::vector<std::string> due(std::int64_t now_ns);
    [[nodiscard]] bool wants(Topic topic) const noexcept;
    [[nodiscard]] std::size_t count() const noexcept;

  private:
    struct Stream {
        Topic topic;
        std::string name;
        std::vector<SubscriptionWish> wishes;
        std::deque<std::shared_ptr<const std::string>> waiting;
        bool sent_before = false;
        std::int64_t last_sent_ns = 0;

        [[nodiscard]] std::int64_t interval_ns() const noexcept;
        [[nodiscard]] std::size_t queue_length() const noexcept;
        void send_due(std::int64_t now_ns, std::vector<std::string>& texts);
    };
    [[nodiscard]] Stream* find(Topic topic) noexcept;

    std::size_t max_count_;
    std::vector<Stream> streams_;
};

}  // namespace surefoot::gate_process
