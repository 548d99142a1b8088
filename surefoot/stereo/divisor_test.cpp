// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/divisor.hpp"

#include <gtest/gtest.h>

namespace surefoot::stereo {
namespace {

/// All floats of one power of two; other powers only change the exponent.
TEST(Divisor, RoundsAsADivisionDoes) {
    for (const int divisor : {12, 100, 720}) {
        const Divisor by(divisor);
        int wrong = 0;
        for (std::uint32_t bits = 0x3f800000U; bits < 0x40000000U; ++bits) {
            const auto x = std::bit_cast<float>(bits);
            wrong += by.divide(x) == x / static_cast<float>(divisor) ? 0 : 1;
        }
        EXPECT_EQ(wrong, 0) << divisor;
    }
}

TEST(Divisor, RoundsAsADivisionDoesForAllCountsOfAWindow) {
    for (int divisor = 1; divisor <= 225; ++divisor) {
        const Divisor by(divisor);
        for (int x = 0; x <= 255; ++x) {
            const auto whole = static_cast<float>(x);
            ASSERT_EQ(by.divide(whole), whole / static_cast<float>(divisor)) << x << " " << divisor;
        }
    }
}

TEST(Divisor, ManyPowersOfTwo) {
    const Divisor by(720);
    for (float x = 0x1.a5c3e7p-60F; x < 0x1p60F; x *= 2.0F) {
        EXPECT_EQ(by.divide(x), x / 720.0F);
        EXPECT_EQ(by.divide(-x), -x / 720.0F);
    }
}

}  // namespace
}  // namespace surefoot::stereo
