// SPDX-License-Identifier: Apache-2.0
#include "service/page/steering.hpp"

#include <utility>

namespace surefoot::page {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
/// A command that is not repeated for this time counts as released.
constexpr std::int64_t kSilence_ns = kSecond_ns;
/// Time that a page keeps the joystick after the release.
constexpr std::int64_t kKept_ns = 5 * kSecond_ns;

}  // namespace

/// Returns the time of the release. A command that is not repeated ends after kSilence_ns.
std::int64_t Steering::let_go_ns() const {
    return command_ == 0 ? last_word_ns_ : last_word_ns_ + kSilence_ns;
}

std::uint64_t Steering::holder_now(std::int64_t now_ns) const {
    return now_ns - let_go_ns() < kKept_ns ? viewer_ : 0;
}

bool Steering::hold(std::uint64_t viewer, std::uint8_t command, std::int64_t now_ns) {
    const std::lock_guard lock(mutex_);
    const std::uint64_t holder = holder_now(now_ns);
    if (holder != 0 && holder != viewer) return false;
    // A release does not take the joystick, and a repeated release does not extend the hold.
    if (holder == 0 && command == 0) return true;
    if (holder == viewer && command_ == 0 && command == 0) return true;
    viewer_ = viewer;
    command_ = command;
    last_word_ns_ = now_ns;
    return true;
}

void Steering::leave(std::uint64_t viewer) {
    const std::lock_guard lock(mutex_);
    if (viewer_ != viewer) return;
    viewer_ = 0;
    command_ = 0;
}

std::uint64_t Steering::holder(std::int64_t now_ns) const {
    const std::lock_guard lock(mutex_);
    return holder_now(now_ns);
}

std::uint8_t Steering::command(std::int64_t now_ns) const {
    const std::lock_guard lock(mutex_);
    return now_ns - last_word_ns_ < kSilence_ns ? command_ : std::uint8_t{0};
}

void Steering::tell(SteerOutcome outcome) {
    const std::lock_guard lock(mutex_);
    outcome.serial = outcome_.serial + 1;
    outcome_ = std::move(outcome);
}

SteerOutcome Steering::outcome() const {
    const std::lock_guard lock(mutex_);
    return outcome_;
}

}  // namespace surefoot::page
