// SPDX-License-Identifier: Apache-2.0
#include "apps/surefoot/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>

namespace surefoot::app {
namespace {

std::atomic<bool> interrupt_seen{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set from a signal handler");

void on_signal(int /*signal*/) {
    interrupt_seen.store(true);
}

}  // namespace

Progress::Progress(std::string label, std::optional<int> total)
    : label_(std::move(label)), total_(total), visible_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
    if (visible_) fmt::print(stderr, "\r\033[K");
}

void Progress::advance(int done) {
    if (!visible_) return;
    if (!total_ || *total_ <= 0) {
        fmt::print(stderr, "\r{} frame {}", label_, done);
        return;
    }
    const int percent = 100 * done / *total_;
    if (percent == last_percent_) return;
    last_percent_ = percent;
    constexpr int kBarWidth = 40;
    const auto filled = static_cast<std::size_t>(kBarWidth * done / *total_);
    fmt::print(stderr,
               "\r{} [{:<{}}] {:3d} % ({}/{})",
               label_,
               std::string(filled, '#'),
               kBarWidth,
               percent,
               done,
               *total_);
    std::fflush(stderr);
}

bool interrupted() {
    return interrupt_seen.load();
}

void watch_for_interrupts() {
    struct sigaction action = {};
    action.sa_handler = on_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND);  // a second Ctrl-C ends the program at once
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

}  // namespace surefoot::app
