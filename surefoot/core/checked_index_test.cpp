// SPDX-License-Identifier: Apache-2.0
#include "surefoot/core/checked_index.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "surefoot/core/unknown.hpp"

namespace surefoot {
namespace {

template <typename Int, typename Real>
void check_ends() {
    using Limits = std::numeric_limits<Int>;
    const auto infinity = std::numeric_limits<Real>::infinity();
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    const Real end = std::ldexp(Real{1}, Limits::digits);
    EXPECT_EQ(checked_integer<Int>(Real{7.5}), Int{7});
    EXPECT_EQ(checked_integer<Int>(Real{-0.5}), Int{0});
    for (const Real out : {end, std::nextafter(end, infinity), infinity, -infinity, nan}) {
        EXPECT_EQ(checked_integer<Int>(out), std::nullopt) << out;
    }
    const Real last = std::nextafter(end, Real{0});
    EXPECT_EQ(checked_integer<Int>(last), static_cast<Int>(last));
    const Real low = static_cast<Real>(Limits::lowest());
    EXPECT_EQ(checked_integer<Int>(low), Limits::lowest());
    EXPECT_EQ(checked_integer<Int>(std::min(low * 2, Real{-1})), std::nullopt);
    EXPECT_EQ(saturated_integer<Int>(infinity), Limits::max());
    EXPECT_EQ(saturated_integer<Int>(-infinity), Limits::lowest());
    EXPECT_EQ(saturated_integer<Int>(nan, Int{5}), Int{5});
    EXPECT_EQ(saturated_integer<Int>(Real{1e30F}), Limits::max());
    EXPECT_EQ(saturated_integer<Int>(Real{-3.4e38F}), Limits::lowest());
    EXPECT_EQ(saturated_integer<Int>(Real{3.5}), Int{3});
}

TEST(CheckedIndex, EndsOfEveryInteger) {
    check_ends<std::int8_t, float>();
    check_ends<std::uint8_t, float>();
    check_ends<std::int32_t, float>();
    check_ends<std::int32_t, double>();
    check_ends<std::uint32_t, float>();
    check_ends<std::uint32_t, double>();
    check_ends<std::int64_t, float>();
    check_ends<std::int64_t, double>();
    check_ends<std::uint64_t, double>();
}

TEST(CheckedIndex, FractionsBeyondTheLastIntegerStillBelongToIt) {
    EXPECT_EQ(checked_integer<std::int32_t>(2147483647.9), 2147483647);
    EXPECT_EQ(checked_integer<std::int32_t>(-2147483648.9), -2147483647 - 1);
    EXPECT_EQ(checked_integer<std::int32_t>(-2147483649.0), std::nullopt);
    EXPECT_EQ(checked_integer<std::uint8_t>(255.9F), 255);
    EXPECT_EQ(checked_integer<std::uint8_t>(-0.5F), 0);
    EXPECT_EQ(checked_integer<std::uint8_t>(-1.0F), std::nullopt);
}

#ifdef SUREFOOT_CHECKS_FLOAT_CASTS
TEST(CheckedIndexDeathTest, TheSanitizerStopsAnUncheckedConversion) {
    const auto convert = [](double value) {
        const volatile double seen = value;                  // hides the value from the compiler
        const volatile int number = static_cast<int>(seen);  // in range: NO, that is the test
        return number;
    };
    for (const double value : {3e38, -2147483649.0, std::nan("")})
        EXPECT_DEATH(static_cast<void>(convert(value)), "outside the range") << value;
    EXPECT_EQ(convert(5.5), 5);
}
#endif

TEST(CheckedIndex, ClampedIntegersStayWithinTheirBoundsForEveryNumber) {
    EXPECT_EQ(clamped_integer<int>(3.9, 0, 10), 3);
    EXPECT_EQ(clamped_integer<int>(-3.9, 0, 10), 0);
    EXPECT_EQ(clamped_integer<int>(1e300, 0, 10), 10);
    EXPECT_EQ(clamped_integer<int>(-1e300, -5, 10), -5);
    EXPECT_EQ(clamped_integer<int>(kNan, -5, 10), 0);
    EXPECT_EQ(clamped_integer<int>(kNan, 2, 10), 2);
}

}  // namespace
}  // namespace surefoot
