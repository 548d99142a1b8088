// SPDX-License-Identifier: Apache-2.0
// The times that are promised, and the ranges of all limits.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/readiness.hpp"
#include "surefoot/gate/readiness_testing.hpp"

namespace surefoot::gate::testing {
namespace {

/// docs/evidence/safety.md and surefoot/gate/README.md state these times; the other tests use them.
TEST(Readiness, the_times_are_those_that_are_promised) {
    const ReadinessLimits limits;
    EXPECT_EQ(limits.warmup_ns, 2 * kSecondNs);
    EXPECT_EQ(limits.warmup_frames, 20);
    EXPECT_EQ(limits.warmup_timeout_ns, 60 * kSecondNs);
    EXPECT_EQ(limits.recover_ns, kSecondNs);
    EXPECT_EQ(limits.recover_frames, 10);
    EXPECT_EQ(limits.degraded_timeout_ns, 10 * kSecondNs);
    EXPECT_EQ(limits.clock_gap_ns, 100 * kMs);
}

TEST(Readiness, every_limit_has_a_range_and_its_ends_are_inside) {
    constexpr std::int64_t kMinute = 60 * kSecondNs;
    const auto is_usable = [](auto set, auto value) {
        ReadinessLimits limits;
        limits.warmup_timeout_ns = limits.degraded_timeout_ns = 10 * kMinute;
        set(limits, value);
        return limits.problem() == nullptr;
    };
    const auto expect_range = [&](const char* name, auto set, auto low, auto high, auto step) {
        EXPECT_TRUE(is_usable(set, low)) << name;
        EXPECT_TRUE(is_usable(set, high)) << name;
        EXPECT_FALSE(is_usable(set, low - step)) << name;
        EXPECT_FALSE(is_usable(set, high + step)) << name;
    };
    constexpr std::int64_t kOne = 1;
    using Limits = ReadinessLimits;
    expect_range(
        "warm-up",
        [](Limits& l, std::int64_t v) { l.warmup_ns = v; },
        kSecondNs / 2,
        kMinute,
        kOne);
    expect_range(
        "recovery",
        [](Limits& l, std::int64_t v) { l.recover_ns = v; },
        kSecondNs / 2,
        kMinute,
        kOne);
    expect_range(
        "frames", [](Limits& l, int v) { l.warmup_frames = v; }, 5, 10'000, 1);
    expect_range(
        "frames to recover", [](Limits& l, int v) { l.recover_frames = v; }, 5, 10'000, 1);
    expect_range(
        "time-out of the warm-up",
        [](Limits& l, std::int64_t v) { l.warmup_timeout_ns = v; },
        Limits{}.warmup_ns + 1,
        10 * kMinute,
        kOne);
    expect_range(
        "time-out of a disturbance",
        [](Limits& l, std::int64_t v) { l.degraded_timeout_ns = v; },
        Limits{}.recover_ns + 1,
        10 * kMinute,
        kOne);
    expect_range(
        "m/s", [](Limits& l, double v) { l.fastest_m_s = v; }, 0.01, 5.0, 1e-6);
    expect_range(
        "rad/s", [](Limits& l, double v) { l.fastest_rad_s = v; }, 0.01, 10.0, 1e-6);
    expect_range(
        "jump", [](Limits& l, double v) { l.jump_m = v; }, 0.001, 0.1, 1e-6);
    expect_range(
        "turn", [](Limits& l, double v) { l.jump_rad = v; }, 0.001, 0.2, 1e-6);
    expect_range(
        "gap between the clocks",
        [](Limits& l, std::int64_t v) { l.clock_gap_ns = v; },
        kSecondNs / 1000,
        kSecondNs,
        kOne);
}

TEST(Readiness, no_limit_can_switch_a_rule_off) {
    EXPECT_EQ(ReadinessLimits{}.problem(), nullptr);
    const auto refused = [](auto change) {
        ReadinessLimits limits;
        change(limits);
        return limits.problem() != nullptr;
    };
    EXPECT_TRUE(refused([](auto& l) { l.warmup_ns = 0; }));
    EXPECT_TRUE(refused([](auto& l) { l.recover_ns = 0; }));
    EXPECT_TRUE(refused([](auto& l) { l.warmup_frames = 0; }));
    EXPECT_TRUE(refused([](auto& l) { l.recover_frames = 0; }));
    EXPECT_TRUE(refused([](auto& l) { l.warmup_timeout_ns = INT64_MAX; }));
    EXPECT_TRUE(refused([](auto& l) { l.warmup_timeout_ns = l.warmup_ns; }));
    EXPECT_TRUE(refused([](auto& l) { l.degraded_timeout_ns = INT64_MAX; }));
    EXPECT_TRUE(refused([](auto& l) { l.degraded_timeout_ns = l.recover_ns; }));
    EXPECT_TRUE(refused([](auto& l) { l.fastest_m_s = 100.0; }));
    EXPECT_TRUE(refused([](auto& l) { l.fastest_rad_s = std::nan(""); }));
    EXPECT_TRUE(refused([](auto& l) { l.jump_m = 10.0; }));
    EXPECT_TRUE(refused([](auto& l) { l.jump_rad = 3.0; }));
    EXPECT_TRUE(refused([](auto& l) { l.clock_gap_ns = INT64_MAX; }));
}

}  // namespace
}  // namespace surefoot::gate::testing
