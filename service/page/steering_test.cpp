// SPDX-License-Identifier: Apache-2.0
#include "service/page/steering.hpp"

#include <gtest/gtest.h>

namespace surefoot::page {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kNow = 50'000 * kMs;
constexpr std::uint64_t kOne = 7;
constexpr std::uint64_t kOther = 8;

TEST(Steering, NobodyHoldsItAtFirst) {
    const Steering steering;
    EXPECT_EQ(steering.holder(kNow), 0U);
    EXPECT_EQ(steering.command(kNow), 0);
    EXPECT_EQ(steering.holder(0), 0U);
    EXPECT_EQ(steering.outcome().command, 0);
}

TEST(Steering, TheFirstHasItAndTheOtherWaits) {
    Steering steering;
    EXPECT_TRUE(steering.hold(kOne, 9, kNow));
    EXPECT_FALSE(steering.hold(kOther, 17, kNow + 10 * kMs));
    EXPECT_FALSE(steering.hold(kOther, 0, kNow + 10 * kMs)) << "nor can it let go for the first";
    EXPECT_EQ(steering.command(kNow + 20 * kMs), 9);
    EXPECT_EQ(steering.holder(kNow + 20 * kMs), kOne);
    EXPECT_TRUE(steering.hold(kOne, 17, kNow + 30 * kMs)) << "its own to change";
    EXPECT_EQ(steering.command(kNow + 40 * kMs), 17);
}

TEST(Steering, ASecondWithoutAWordIsLettingGo) {
    Steering steering;
    steering.hold(kOne, 9, kNow);
    EXPECT_EQ(steering.command(kNow + 999 * kMs), 9);
    EXPECT_EQ(steering.command(kNow + 1000 * kMs), 0);
    steering.hold(kOne, 9, kNow + 900 * kMs);
    EXPECT_EQ(steering.command(kNow + 1899 * kMs), 9) << "said again";
    EXPECT_EQ(steering.command(kNow + 1900 * kMs), 0);
    EXPECT_FALSE(steering.hold(kOther, 9, kNow + 6899 * kMs)) << "5 s after it was let go";
    EXPECT_TRUE(steering.hold(kOther, 9, kNow + 6900 * kMs));
    EXPECT_EQ(steering.holder(kNow + 6901 * kMs), kOther);
}

TEST(Steering, LettingGoKeepsItForFiveSecondsAndNoLonger) {
    Steering steering;
    steering.hold(kOne, 9, kNow);
    steering.hold(kOne, 0, kNow + 100 * kMs);
    EXPECT_EQ(steering.command(kNow + 101 * kMs), 0);
    steering.hold(kOne, 0, kNow + 4000 * kMs);  // said again: not a new grip
    EXPECT_EQ(steering.holder(kNow + 5099 * kMs), kOne);
    EXPECT_EQ(steering.holder(kNow + 5100 * kMs), 0U);
    EXPECT_TRUE(steering.hold(kOther, 0, kNow + 5200 * kMs));
    EXPECT_EQ(steering.holder(kNow + 5200 * kMs), 0U) << "who asks for nothing takes nothing";
}

TEST(Steering, WhoGoesLeavesItAtRest) {
    Steering steering;
    steering.hold(kOne, 9, kNow);
    steering.leave(kOther);
    EXPECT_EQ(steering.command(kNow), 9);
    steering.leave(kOne);
    EXPECT_EQ(steering.command(kNow), 0);
    EXPECT_TRUE(steering.hold(kOther, 17, kNow + kMs));
}

TEST(Steering, OutcomesAreCounted) {
    Steering steering;
    steering.tell({0, 9, "OK", true, ""});
    steering.tell({0, 17, "NOT_TRAVERSABLE", false, "drop of 0.17 m"});
    const SteerOutcome last = steering.outcome();
    EXPECT_EQ(last.serial, 2U);
    EXPECT_EQ(last.command, 17);
    EXPECT_EQ(last.text, "drop of 0.17 m");
}

}  // namespace
}  // namespace surefoot::page
