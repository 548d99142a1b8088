// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/tracking/robust_mean.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/core/rng.hpp"

namespace surefoot::stairs {
namespace {

constexpr int kMost = RobustMean::kMostObservations;

TEST(RobustMean, nothing_has_no_mean) {
    const RobustMean mean;
    EXPECT_TRUE(mean.empty());
    EXPECT_TRUE(std::isnan(mean.mean(0.001).value));
}

TEST(RobustMean, one_look_is_what_it_says) {
    RobustMean mean;
    mean.add(0.3, 0.004, kMost);
    EXPECT_FALSE(mean.empty());
    EXPECT_DOUBLE_EQ(mean.mean(0.003).value, 0.3);
    EXPECT_DOUBLE_EQ(mean.mean(0.003).sigma, 0.005);
}

TEST(RobustMean, sure_looks_count_more_and_errors_cancel_out) {
    RobustMean mean;
    mean.add(0.300, 0.001, kMost);
    mean.add(0.306, 0.002, kMost);
    EXPECT_NEAR(mean.mean(0.01).value, (4.0 * 0.300 + 0.306) / 5.0, 1e-12);
    RobustMean alike;
    for (int i = 0; i < 16; ++i) alike.add(0.3, 0.004, kMost);
    EXPECT_NEAR(alike.mean(0.0).sigma, 0.001, 1e-12);
}

TEST(RobustMean, looks_that_scatter_more_than_they_say_make_it_less_sure) {
    Rng rng(3);
    RobustMean mean;
    for (int i = 0; i < kMost; ++i) mean.add(0.3 + 0.0025 * rng.normal(), 0.001, kMost);
    EXPECT_GT(mean.mean(0.0).sigma, 1.3 * 0.001 / std::sqrt(kMost));
}

TEST(RobustMean, looks_that_are_wrong_and_sure_do_not_move_it) {
    Rng rng(7);
    RobustMean mean;
    for (int i = 0; i < kMost; ++i)
        mean.add(i % 5 == 0 ? 0.6 : 0.3 + 0.004 * rng.normal(), 0.004, kMost);
    EXPECT_NEAR(mean.mean(0.0).value, 0.3, 0.003);
    EXPECT_LT(mean.mean(0.0).sigma, 0.002);
}

TEST(RobustMean, what_is_known_better_than_most_is_what_counts) {
    RobustMean mean;
    for (int i = 0; i < 20; ++i) mean.add(0.36, 0.03, kMost);
    for (int i = 0; i < 5; ++i) mean.add(0.30, 0.001, kMost);
    EXPECT_NEAR(mean.mean(0.0).value, 0.30, 0.001);
}

TEST(RobustMean, the_oldest_look_is_forgotten) {
    RobustMean few;
    RobustMean all;
    for (int i = 0; i < 3; ++i) few.add(0.1 * i, 1.0, 2);
    for (int i = 0; i < kMost + 4; ++i) all.add(i, 1000.0, kMost);
    EXPECT_NEAR(few.mean(0.0).value, 0.15, 1e-12);
    EXPECT_NEAR(all.mean(0.0).value, 4.0 + 0.5 * (kMost - 1), 1e-9);
    for (int i = 0; i < 2; ++i) all.add(7.0, 1.0, 1);
    EXPECT_EQ(all.mean(0.5).value, 7.0);
    EXPECT_DOUBLE_EQ(all.mean(0.0).sigma, 1.0);
}

}  // namespace
}  // namespace surefoot::stairs
