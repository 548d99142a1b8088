// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/monotonic.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "surefoot/core/rng.hpp"

namespace surefoot::camera {
namespace {

double value_at(std::span<const double> c, double s) {
    double sum = 0.0;
    for (std::size_t i = c.size(); i-- > 0;) sum = sum * s + c[i];
    return sum;
}

TEST(PositiveOn, AConstantIsItsSign) {
    EXPECT_TRUE(positive_on(std::array{1.0}, 3.0));
    EXPECT_FALSE(positive_on(std::array{0.0}, 3.0));
    EXPECT_FALSE(positive_on(std::array{-1.0}, 3.0));
}

TEST(PositiveOn, SeesADipBetweenPositiveEnds) {
    // (s - 1)^2 - 0.01 is negative only around s = 1.
    const std::array dip{0.99, -2.0, 1.0};
    EXPECT_TRUE(positive_on(dip, 0.89));
    EXPECT_FALSE(positive_on(dip, 1.0));
    EXPECT_FALSE(positive_on(dip, 5.0));
    const std::array clear{1.01, -2.0, 1.0};
    EXPECT_TRUE(positive_on(clear, 5.0));
}

TEST(PositiveOn, NanAndInfinityAreNotPositive) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(positive_on(std::array{1.0, nan}, 1.0));
    EXPECT_FALSE(positive_on(std::array{1.0, 0.5}, nan));
    EXPECT_FALSE(positive_on(std::array{1.0, 0.0}, std::numeric_limits<double>::infinity()));
}

TEST(PositiveOn, AgreesWithDenseSampling) {
    constexpr int kPolynomials = 3000;
    constexpr int kSamples = 2000;
    Rng rng(7);
    int positive = 0;
    for (int n = 0; n < kPolynomials; ++n) {
        std::array<double, 5> c{1.0, 0.0, 0.0, 0.0, 0.0};
        for (std::size_t i = 1; i < c.size(); ++i) c[i] = rng.uniform(-1.0, 1.0);
        const double s_max = rng.uniform(0.0, 4.0);
        double lowest = std::numeric_limits<double>::infinity();
        for (int i = 0; i <= kSamples; ++i) {
            lowest = std::min(lowest, value_at(c, s_max * i / kSamples));
        }
        // Sampling cannot resolve a minimum so close to zero.
        if (std::abs(lowest) < 1e-3) continue;
        EXPECT_EQ(positive_on(c, s_max), lowest > 0.0)
            << "polynomial " << n << ", s_max " << s_max << ", lowest sample " << lowest;
        positive += lowest > 0.0 ? 1 : 0;
    }
    EXPECT_GT(positive, kPolynomials / 10);
}

}  // namespace
}  // namespace surefoot::camera
