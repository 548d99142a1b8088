// SPDX-License-Identifier: Apache-2.0
#include "service/console/interrupt.hpp"

#include <atomic>
#include <csignal>

namespace surefoot::app {
namespace {

std::atomic<bool> interrupt_seen{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set from a signal handler");

void on_signal(int /*signal*/) {
    interrupt_seen.store(true);
}

}  // namespace

void watch_for_interrupts() {
    struct sigaction action = {};
    action.sa_handler = on_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND);  // a second signal ends the program
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() {
    return interrupt_seen.load();
}

}  // namespace surefoot::app
