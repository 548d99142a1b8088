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

/// A message of a topic. The JSON of its body is shared by all connections that it waits in.
struct TopicMessage {
    Topic topic = Topic::health;
    std::shared_ptr<const std::string> body;
};

/// How often a client wants a topic. rosbridge's throttle_rate is a time in ms, its queue_length
/// the number of messages kept while that time runs.
struct SubscriptionWish {
    std::string id;  ///< may be empty
    std::int64_t interval_ns = 0;
    std::size_t queue_length = 0;
};

/// What one connection subscribed to. Several subscriptions to a topic are one stream, at the
/// shortest interval and with the longest queue that was asked for. While the interval runs the
/// newest messages are kept, one at least, so that a slow listener ends with the last state.
class Subscriptions {
  public:
    explicit Subscriptions(std::size_t max_count) : max_count_(max_count) {}

    /// `name` as the client spells it: that is what it listens to. A wish of the same id replaces
    /// the one before. Fails beyond the limit.
    [[nodiscard]] Status add(Topic topic, std::string name, SubscriptionWish wish);
    /// All wishes for the topic when the id is empty. False: there was none.
    bool remove(Topic topic, const std::string& id);
    /// The whole text to send now, or nothing.
    [[nodiscard]] std::vector<std::string> offer(const TopicMessage& message, std::int64_t now_ns);
    /// What has waited for its interval.
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
