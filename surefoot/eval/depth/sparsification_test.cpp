// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/depth/sparsification.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::eval {
namespace {

constexpr double kRounding = 1e-12;

/// Reference implementation for sigmas that all differ: sorts, removes and averages from the start
/// each time.
double area_slowly(const std::vector<float>& errors, const std::vector<float>& keys) {
    std::vector<std::size_t> order(errors.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return keys[a] < keys[b]; });
    double area = 0.0;
    for (std::size_t m = 1; m <= order.size(); ++m) {
        double sum = 0.0;
        for (std::size_t k = 0; k < m; ++k) sum += std::abs(static_cast<double>(errors[order[k]]));
        area += sum / static_cast<double>(m);
    }
    return area / static_cast<double>(order.size());
}

TEST(Sparsification, ThreeValuesByHand) {
    // |errors| 1, 2, 3 in the order of sigma 2, 3, 1: E = 2, 5/2, 6/3.
    const auto result =
        sparsification(std::vector<float>{-3.0F, 2.0F, 1.0F}, std::vector<float>{0.3F, 0.1F, 0.2F});
    EXPECT_EQ(result.count, 3);
    // most sure first: 2, 1, 3 -> E = 2, 1.5, 2
    EXPECT_NEAR(result.area, (2.0 + 1.5 + 2.0) / 3.0, kRounding);
    EXPECT_NEAR(result.oracle_area, (1.0 + 1.5 + 2.0) / 3.0, kRounding);
    EXPECT_NEAR(result.random_area, 2.0, kRounding);
    EXPECT_NEAR(result.auc, (5.5 - 4.5) / (6.0 - 4.5), kRounding);
}

TEST(Sparsification, APerfectOrderIsZeroAndTheWorstIsAboveOne) {
    Rng rng(1);
    std::vector<float> errors, perfect, reversed;
    for (int i = 0; i < 500; ++i) {
        errors.push_back(static_cast<float>(rng.normal()));
        perfect.push_back(2.0F * std::abs(errors.back()));
        reversed.push_back(1.0F / std::abs(errors.back()));
    }
    EXPECT_NEAR(sparsification(errors, perfect).auc, 0.0, kRounding);
    EXPECT_GT(sparsification(errors, reversed).auc, 1.5);
}

TEST(Sparsification, ARandomOrderIsOneAndAnHonestSigmaInBetween) {
    Rng rng(2);
    double random_sum = 0.0;
    double honest_sum = 0.0;
    constexpr int kTrials = 40;
    for (int trial = 0; trial < kTrials; ++trial) {
        std::vector<float> errors, random, honest;
        for (int i = 0; i < 2000; ++i) {
            const double sigma = std::exp(rng.normal());
            honest.push_back(static_cast<float>(sigma));
            errors.push_back(static_cast<float>(sigma * rng.normal()));
            random.push_back(static_cast<float>(rng.uniform()));
        }
        random_sum += sparsification(errors, random).auc;
        honest_sum += sparsification(errors, honest).auc;
    }
    // The figure of one random order scatters by about 0.053 here, the mean of 40 by 0.0084; three
    // times that is allowed.
    EXPECT_NEAR(random_sum / kTrials, 1.0, 0.025);
    EXPECT_GT(honest_sum / kTrials, 0.1);
    EXPECT_LT(honest_sum / kTrials, 0.6);
}

TEST(Sparsification, OneSigmaForAllIsExactlyChance) {
    const std::vector<float> errors = {5.0F, -1.0F, 0.0F, 2.0F};
    const auto result = sparsification(errors, std::vector<float>(4, 0.7F));
    EXPECT_NEAR(result.auc, 1.0, kRounding);
    EXPECT_NEAR(result.area, result.random_area, kRounding);
}

TEST(Sparsification, TiesAreTheMeanOverTheirOrders) {
    const std::vector<float> errors = {1.0F, 4.0F, 2.0F, 8.0F};
    const std::vector<float> tied = {0.2F, 0.2F, 0.2F, 0.1F};
    std::vector<float> orders = {0.2F, 0.3F, 0.4F};
    double sum = 0.0;
    int count = 0;
    do {
        sum += area_slowly(errors, {orders[0], orders[1], orders[2], 0.1F});
        ++count;
    } while (std::next_permutation(orders.begin(), orders.end()));
    EXPECT_EQ(count, 6);
    EXPECT_NEAR(sparsification(errors, tied).area, sum / count, kRounding);
}

TEST(Sparsification, AgreesWithTheDefinition) {
    Rng rng(3);
    for (int trial = 0; trial < 20; ++trial) {
        std::vector<float> errors, sigmas, absolute;
        const auto count = 1 + rng.below(60);
        for (std::uint64_t i = 0; i < count; ++i) {
            errors.push_back(static_cast<float>(rng.normal()));
            absolute.push_back(std::abs(errors.back()));
            sigmas.push_back(static_cast<float>(rng.uniform()));
        }
        const auto result = sparsification(errors, sigmas);
        EXPECT_NEAR(result.area, area_slowly(errors, sigmas), kRounding) << "trial " << trial;
        EXPECT_NEAR(result.oracle_area, area_slowly(errors, absolute), kRounding);
        EXPECT_LE(result.oracle_area, result.area + kRounding);
        // The order of the input plays no part.
        std::reverse(errors.begin(), errors.end());
        std::reverse(sigmas.begin(), sigmas.end());
        EXPECT_EQ(sparsification(errors, sigmas).area, result.area);
    }
}

TEST(Sparsification, NothingToFindIsNan) {
    EXPECT_TRUE(std::isnan(sparsification({}, {}).auc));
    EXPECT_EQ(sparsification({}, {}).count, 0);
    const std::vector<float> three = {1.0F, 2.0F, 3.0F};
    EXPECT_EQ(sparsification(three, std::vector<float>(3, kNanF)).count, 0);
    EXPECT_EQ(sparsification(std::vector<float>(3, kNanF), three).count, 0);
    EXPECT_TRUE(std::isnan(sparsification(std::vector<float>{-0.1F, 0.1F, 0.1F}, three).auc));
    EXPECT_TRUE(std::isnan(sparsification(std::vector<float>{0.0F}, std::vector<float>{1.0F}).auc));
}

}  // namespace
}  // namespace surefoot::eval
