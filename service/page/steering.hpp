// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <mutex>
#include <string>

namespace surefoot::page {

/// The result of the last movement that a page requested.
struct SteerOutcome {
    std::uint64_t serial = 0;  ///< increases with each outcome
    std::uint8_t command = 0;
    std::string verdict;  ///< verdict of the gate's last answer; "-" if no answer came
    bool moved = false;
    std::string text;  ///< reason that the gate gave, a sentence for the user
};

/// The joystick of a simulated machine, shared by all pages. Only one page holds it at a time. That
/// page keeps it until 5 s after the release, or until the page disconnects. A page that holds the
/// joystick must repeat its command; 1 s without a command counts as a release. Thread-safe; times
/// are those of the steady clock.
class Steering {
  public:
    /// The page `viewer` (never 0) holds the joystick at `command`, or releases the joystick with
    /// 0. Returns false and changes nothing while another page holds the joystick.
    bool hold(std::uint64_t viewer, std::uint8_t command, std::int64_t now_ns);
    /// Releases the joystick at once if the disconnected page `viewer` held it.
    void leave(std::uint64_t viewer);
    /// Returns the page that holds the joystick; 0 = no page.
    [[nodiscard]] std::uint64_t holder(std::int64_t now_ns) const;
    /// Returns the current command; 0 = at rest.
    [[nodiscard]] std::uint8_t command(std::int64_t now_ns) const;

    /// Stores the outcome and gives it the next serial.
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
