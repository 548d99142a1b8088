// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <mutex>
#include <string>

namespace surefoot::page {

/// What became of the last movement that a page asked for.
struct SteerOutcome {
    std::uint64_t serial = 0;  ///< grows with each
    std::uint8_t command = 0;
    std::string verdict;  ///< of the gate's last answer; "-" where none came
    bool moved = false;
    std::string text;  ///< the gate's reason, a sentence for people
};

/// The joystick of a simulated machine on the pages: one page holds it, the others are told. Who
/// holds it has it until it was let go for five seconds, or the page went. A page says again and
/// again that it holds; a second without a word is as if it had let go. Any thread; times are the
/// steady clock's.
class Steering {
  public:
    /// The page `viewer` (never 0) holds the joystick at `command`, or lets go with 0. False, and
    /// nothing changes, while another page has it.
    bool hold(std::uint64_t viewer, std::uint8_t command, std::int64_t now_ns);
    void leave(std::uint64_t viewer);
    /// The page that has it; 0 = none.
    [[nodiscard]] std::uint64_t holder(std::int64_t now_ns) const;
    /// Where the joystick stands; 0 = at rest.
    [[nodiscard]] std::uint8_t command(std::int64_t now_ns) const;

    /// Gives the outcome the next serial.
    void tell(SteerOutcome outcome);
    [[nodiscard]] SteerOutcome outcome() const;

  private:
    [[nodiscard]] std::int64_t let_go_ns() const;
    [[nodiscard]] std::uint64_t holder_now(std::int64_t now_ns) const;

    mutable std::mutex mutex_;
    std::uint64_t viewer_ = 0;
    std::uint8_t command_ = 0;
    std::int64_t last_word_ns_ = 0;
    SteerOutcome outcome_;
};

}  // namespace surefoot::page
