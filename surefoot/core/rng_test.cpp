// SPDX-License-Identifier: Apache-2.0
#include "surefoot/core/rng.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace surefoot {
namespace {

TEST(Rng, same_seed_same_numbers_other_seed_others) {
    Rng a(7);
    Rng b(7);
    Rng c(8);
    bool differs = false;
    for (int i = 0; i < 100; ++i) {
        const auto value = a.next_u64();
        EXPECT_EQ(value, b.next_u64());
        differs = differs || value != c.next_u64();
    }
    EXPECT_TRUE(differs);
}

TEST(Rng, normal_has_unit_moments) {
    Rng rng(1);
    constexpr int kSamples = 200000;
    double sum = 0.0;
    double sum_sq = 0.0;
    double sum_4 = 0.0;
    for (int i = 0; i < kSamples; ++i) {
        const double x = rng.normal();
        sum += x;
        sum_sq += x * x;
        sum_4 += x * x * x * x;
    }
    const double standard_error = 1.0 / std::sqrt(double{kSamples});
    EXPECT_NEAR(sum / kSamples, 0.0, 5 * standard_error);
    EXPECT_NEAR(sum_sq / kSamples, 1.0, 5 * std::sqrt(2.0) * standard_error);
    EXPECT_NEAR(sum_4 / kSamples, 3.0, 5 * std::sqrt(96.0) * standard_error);
}

TEST(Rng, below_covers_its_range_evenly) {
    Rng rng(2);
    int hits[5] = {};
    constexpr int kSamples = 50000;
    for (int i = 0; i < kSamples; ++i) ++hits[rng.below(5)];
    for (const int count : hits) EXPECT_NEAR(count, kSamples / 5, 5 * std::sqrt(kSamples * 0.16));
    EXPECT_EQ(rng.below(1), 0U);
}

TEST(Rng, streams_of_one_seed_differ) {
    EXPECT_NE(mix_seed(1, 0), mix_seed(1, 1));
    EXPECT_NE(mix_seed(1, 0), mix_seed(2, 0));
}

}  // namespace
}  // namespace surefoot
