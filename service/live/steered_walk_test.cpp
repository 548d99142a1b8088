// SPDX-License-Identifier: Apache-2.0
#include "service/live/steered_walk.hpp"

#include <gtest/gtest.h>

namespace surefoot::app {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::uint8_t kAhead = 9;

AskedStep refused() {
    return {kAhead, false, "ERROR", "the gate is not ready"};
}

TEST(ScriptedWalker, AsksAgainWhereTheGateCannotJudge) {
    const auto walker = scripted_walker({kAhead, 17});
    EXPECT_EQ(walker->joystick(0), kAhead);
    EXPECT_FALSE(walker->answered(refused(), false, 0)) << "no news";
    EXPECT_EQ(walker->joystick(kSecond_ns / 10), 0) << "a rest before it is asked again";
    EXPECT_EQ(walker->joystick(kSecond_ns), kAhead);
    EXPECT_TRUE(walker->answered({kAhead, true, "OK", ""}, true, kSecond_ns));
    EXPECT_EQ(walker->joystick(2 * kSecond_ns), 17);
    EXPECT_TRUE(walker->answered({17, false, "NOT_TRAVERSABLE", ""}, true, 2 * kSecond_ns));
    EXPECT_EQ(walker->joystick(3 * kSecond_ns), std::nullopt) << "all was asked";
}

TEST(ScriptedWalker, GivesUpAGateThatNeverJudges) {
    const auto walker = scripted_walker({kAhead, kAhead});
    EXPECT_FALSE(walker->answered(refused(), false, 5 * kSecond_ns));
    EXPECT_FALSE(walker->answered(refused(), false, 124 * kSecond_ns));
    EXPECT_EQ(walker->joystick(124 * kSecond_ns + kSecond_ns / 2), kAhead);
    EXPECT_TRUE(walker->answered(refused(), false, 125 * kSecond_ns)) << "its answer is told";
    EXPECT_EQ(walker->joystick(126 * kSecond_ns), std::nullopt);
}

TEST(ScriptedWalker, PatienceBeginsAnewWithEachMovement) {
    const auto walker = scripted_walker({kAhead, kAhead});
    EXPECT_FALSE(walker->answered(refused(), false, 0));
    EXPECT_TRUE(walker->answered({kAhead, true, "OK", ""}, true, 100 * kSecond_ns));
    EXPECT_FALSE(walker->answered(refused(), false, 130 * kSecond_ns));
    EXPECT_FALSE(walker->answered(refused(), false, 249 * kSecond_ns));
    EXPECT_TRUE(walker->answered(refused(), false, 250 * kSecond_ns));
}

}  // namespace
}  // namespace surefoot::app
