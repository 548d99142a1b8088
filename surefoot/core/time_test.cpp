// SPDX-License-Identifier: Apache-2.0
#include "surefoot/core/time.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace surefoot {
namespace {

TEST(Time, SecondsBecomeTheNearestNanosecond) {
    EXPECT_EQ(ns_from_seconds(0.0), 0);
    EXPECT_EQ(ns_from_seconds(1.5e-9), 2);
    EXPECT_EQ(ns_from_seconds(-1.5e-9), -2);
    EXPECT_EQ(ns_from_seconds(1.25), 1'250'000'000);
    EXPECT_EQ(ns_from_seconds(1.8e9), 1'800'000'000 * kNanosecondsPerSecond);
    static_assert(ns_from_seconds(2.0) == 2 * kNanosecondsPerSecond);
}

TEST(Time, ASumWithSecondsBeyondAllClocksDoesNotOverflow) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    constexpr std::int64_t kHalfWay_ns = std::numeric_limits<std::int64_t>::max() / 2;
    for (const double far_s : {1e10, 1e300, kInfinity}) {
        // A plain conversion would give the smallest integer, a time in the distant past.
        EXPECT_GT(ns_from_seconds(far_s), 4'000'000'000 * kNanosecondsPerSecond) << far_s;
        EXPECT_GT(kHalfWay_ns + ns_from_seconds(far_s), kHalfWay_ns) << far_s;
        EXPECT_EQ(ns_from_seconds(-far_s), -ns_from_seconds(far_s));
    }
    EXPECT_EQ(ns_from_seconds(std::nan("")), 0);
}

}  // namespace
}  // namespace surefoot
