// SPDX-License-Identifier: Apache-2.0
#include "service/console/interrupt.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>

namespace surefoot::app {
namespace {

/// Watches in a child process, raises the signals, and exits with 0 if it is still there.
[[noreturn]] void raise_in_turn(int first, int second) {
    watch_for_interrupts();
    std::raise(first);
    if (!interrupted()) _exit(1);
    if (second != 0) std::raise(second);
    _exit(0);
}

TEST(Interrupt, TheFirstSignalOnlySetsTheFlag) {
    EXPECT_EXIT(raise_in_turn(SIGINT, 0), ::testing::ExitedWithCode(0), "");
    EXPECT_EXIT(raise_in_turn(SIGTERM, 0), ::testing::ExitedWithCode(0), "");
}

TEST(Interrupt, ASecondSignalOfEitherKindEndsTheProgram) {
    EXPECT_EXIT(raise_in_turn(SIGINT, SIGINT), ::testing::KilledBySignal(SIGINT), "");
    EXPECT_EXIT(raise_in_turn(SIGINT, SIGTERM), ::testing::KilledBySignal(SIGTERM), "");
    EXPECT_EXIT(raise_in_turn(SIGTERM, SIGINT), ::testing::KilledBySignal(SIGINT), "");
}

}  // namespace
}  // namespace surefoot::app
