// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/report/error_bins.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::eval {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kRounding = 1e-12;

TEST(ErrorBins, FiguresByHand) {
    const std::vector<float> errors = {-4.0F, kNanF, 1.0F, 2.0F, -3.0F, 0.0F};
    const ErrorFigures figures = error_figures(errors);
    EXPECT_EQ(figures.count, 5);
    EXPECT_EQ(figures.median_abs, 2.0);            // 0 1 2 3 4
    EXPECT_NEAR(figures.p90_abs, 3.6, kRounding);  // rank 3.6 of 0..4
    EXPECT_NEAR(figures.p99_abs, 3.96, kRounding);
    EXPECT_EQ(figures.max_abs, 4.0);
    EXPECT_NEAR(figures.mean, -0.8, kRounding);
    EXPECT_NEAR(figures.rmse, std::sqrt(6.0), kRounding);  // (16 + 1 + 4 + 9) / 5
}

TEST(ErrorBins, EachBinHasTheHistogramOfItsErrors) {
    const std::vector<float> errors = {-0.004F, kNanF, 0.001F, 0.02F};
    const std::vector<float> keys = {0.5F, 0.5F, 1.5F, 1.6F};
    const std::vector<double> edges = {0.0, 1.0, 2.0};
    const auto bins = by_bins(errors, keys, edges);
    ErrorHistogram first;
    first.add(0.004);
    ErrorHistogram second;
    second.add(0.001);
    second.add(0.02);
    EXPECT_EQ(bins[0].histogram, first);
    EXPECT_EQ(bins[1].histogram, second);
}

TEST(ErrorBins, NothingGivesNanAndZero) {
    for (const auto& errors : {std::vector<float>{}, std::vector<float>{kNanF, kNanF}}) {
        const ErrorFigures figures = error_figures(errors);
        EXPECT_EQ(figures.count, 0);
        for (const double figure : {figures.median_abs,
                                    figures.p90_abs,
                                    figures.p99_abs,
                                    figures.max_abs,
                                    figures.mean,
                                    figures.rmse}) {
            EXPECT_TRUE(std::isnan(figure));
        }
    }
    EXPECT_TRUE(by_bins({}, {}, {}).empty());
    EXPECT_TRUE(by_bins({}, {}, std::vector<double>{1.0}).empty());
}

TEST(ErrorBins, BordersBelongToTheUpperBinAndTheLastToTheLast) {
    const std::vector<double> edges = {0.0, 1.0, 3.0};
    const std::vector<float> keys = {-0.1F, 0.0F, 0.9F, 1.0F, 3.0F, 3.1F, kNanF, 0.5F};
    const std::vector<float> errors = {9.0F, 1.0F, 2.0F, 3.0F, 4.0F, 9.0F, 9.0F, kNanF};
    const auto bins = by_bins(errors, keys, edges);
    ASSERT_EQ(bins.size(), 2u);
    EXPECT_EQ(bins[0].from, 0.0);
    EXPECT_EQ(bins[0].to, 1.0);
    EXPECT_EQ(bins[0].errors.count, 2);
    EXPECT_EQ(bins[0].errors.mean, 1.5);
    EXPECT_EQ(bins[1].errors.count, 2);
    EXPECT_EQ(bins[1].errors.mean, 3.5);
}

TEST(ErrorBins, EveryBinIsWhatAFilterFinds) {
    Rng rng(1);
    std::vector<float> errors, keys;
    for (int i = 0; i < 2000; ++i) {
        errors.push_back(static_cast<float>(rng.normal()));
        keys.push_back(static_cast<float>(rng.below(12)) - 1.0F);  // hits the borders often
    }
    const std::vector<double> edges = {0.0, 2.0, 2.5, 7.0, 10.0};
    const auto bins = by_bins(errors, keys, edges);
    for (std::size_t k = 0; k < bins.size(); ++k) {
        std::vector<float> expected;
        for (std::size_t i = 0; i < errors.size(); ++i) {
            const auto key = static_cast<double>(keys[i]);
            const bool last = k + 1 == bins.size();
            if (key >= edges[k] && (key < edges[k + 1] || (last && key == edges[k + 1])))
                expected.push_back(errors[i]);
        }
        EXPECT_EQ(bins[k].errors.count, static_cast<std::int64_t>(expected.size()));
        ASSERT_FALSE(expected.empty()) << "the draw must reach every bin";
        EXPECT_EQ(bins[k].errors.rmse, error_figures(expected).rmse);
    }
    EXPECT_EQ(bins[1].errors.count + bins[0].errors.count,
              std::count_if(keys.begin(), keys.end(), [](float k) { return k >= 0 && k < 2.5F; }));
}

TEST(SigmaCoverage, CountsByHand) {
    const std::vector<float> errors = {
        0.5F, -1.0F, 1.5F, -3.0F, 3.5F, kNanF, 1.0F, 1.0F, 0.0F, 1.0F};
    const std::vector<float> sigmas = {
        1.0F, 1.0F, 1.0F, 1.0F, 1.0F, 1.0F, kNanF, -1.0F, 0.0F, kInfinity};
    const SigmaCoverage coverage = sigma_coverage(errors, sigmas);
    EXPECT_EQ(coverage.count, 6);
    EXPECT_EQ(coverage.within_1_sigma, 3.0 / 6.0);  // 0.5, -1, and 0 at sigma 0
    EXPECT_EQ(coverage.within_2_sigma, 4.0 / 6.0);
    EXPECT_EQ(coverage.within_3_sigma, 5.0 / 6.0);
    EXPECT_EQ(sigma_coverage(std::vector<float>{1e-9F}, std::vector<float>{0.0F}).within_3_sigma,
              0.0);
}

TEST(SigmaCoverage, AnHonestNormalSigmaGivesTheNormalShares) {
    Rng rng(2);
    std::vector<float> errors, sigmas;
    constexpr int kCount = 100000;
    for (int i = 0; i < kCount; ++i) {
        const double sigma = rng.uniform(0.001, 0.1);
        sigmas.push_back(static_cast<float>(sigma));
        errors.push_back(static_cast<float>(sigma * rng.normal()));
    }
    const SigmaCoverage coverage = sigma_coverage(errors, sigmas);
    // Shares of a normal distribution; 4 standard deviations of a binomial share.
    const auto tolerance = [](double p) { return 4.0 * std::sqrt(p * (1.0 - p) / kCount); };
    EXPECT_NEAR(coverage.within_1_sigma, 0.682689, tolerance(0.682689));
    EXPECT_NEAR(coverage.within_2_sigma, 0.954500, tolerance(0.954500));
    EXPECT_NEAR(coverage.within_3_sigma, 0.997300, tolerance(0.997300));
}

TEST(SigmaCoverage, NothingGivesNan) {
    const SigmaCoverage coverage = sigma_coverage({}, {});
    EXPECT_EQ(coverage.count, 0);
    EXPECT_TRUE(std::isnan(coverage.within_1_sigma));
    EXPECT_TRUE(std::isnan(coverage.within_3_sigma));
}

}  // namespace
}  // namespace surefoot::eval
