// SPDX-License-Identifier: Apache-2.0
#include "service/console/interrupt.hpp"

#include <atomic>
#include <csignal>

namespace surefoot::app {
namespace {

std::atomic<bool> interrupt_seen{false};
static_assert(std::atomic<bool>::is_always_lock_free,
              "a signal handler sets this flag, so the flag must be lock-free");

void on_signal(int signal) {
    if (!interrupt_seen.exchange(true)) return;
    std::signal(signal, SIG_DFL);  // the second signal, SIGINT or SIGTERM, ends the program
    std::raise(signal);
}

}  // namespace

void watch_for_interrupts() {
    struct sigaction action = {};
    action.sa_handler = on_signal;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() {
    return interrupt_seen.load();
}

}  // namespace surefoot::app
