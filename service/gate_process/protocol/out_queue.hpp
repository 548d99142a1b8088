// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <utility>

namespace surefoot::gate_process {

/// Texts that wait for a socket. Replies come before topic messages; each kind keeps its order.
class OutQueue {
  public:
    explicit OutQueue(std::size_t max_bytes) : max_bytes_(max_bytes) {}

    /// Adds a text. Returns false and keeps nothing if the queue is full: the client does not read.
    [[nodiscard]] bool push_reply(std::string text) { return push(replies_, std::move(text)); }
    [[nodiscard]] bool push_topic(std::string text) { return push(topics_, std::move(text)); }

    [[nodiscard]] bool empty() const noexcept { return replies_.empty() && topics_.empty(); }
    /// Removes and returns the next text. Precondition: the queue is not empty.
    [[nodiscard]] std::string pop() {
        auto& from = replies_.empty() ? topics_ : replies_;
        std::string text = std::move(from.front());
        from.pop_front();
        bytes_ -= text.size();
        return text;
    }

  private:
    bool push(std::deque<std::string>& to, std::string text) {
        if (text.size() > max_bytes_ - bytes_) return false;
        bytes_ += text.size();
        to.push_back(std::move(text));
        return true;
    }

    std::size_t max_bytes_;
    std::size_t bytes_ = 0;
    std::deque<std::string> replies_;
    std::deque<std::string> topics_;
};

}  // namespace surefoot::gate_process
