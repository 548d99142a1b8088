// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/report/error_histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/eval/report/percentile.hpp"

namespace surefoot::eval {
namespace {

TEST(ErrorHistogram, PercentilesOfManyMapsTogetherWithinATenth) {
    // The plain twin keeps every error.
    Rng rng(7);
    ErrorHistogram pooled;
    std::vector<double> all;
    for (int map = 0; map < 5; ++map) {
        ErrorHistogram one;
        const double sigma_m = 0.002 * (map + 1);
        for (int i = 0; i < 2000; ++i) {
            const double error_m = sigma_m * rng.normal();
            one.add(error_m);
            all.push_back(std::abs(error_m));
        }
        pooled += one;
    }
    std::sort(all.begin(), all.end());
    ASSERT_EQ(pooled.count(), static_cast<std::int64_t>(all.size()));
    for (const double fraction : {0.1, 0.5, 0.9, 0.99}) {
        const double exact_m = percentile_of_sorted(all, fraction);
        EXPECT_NEAR(pooled.percentile(fraction), exact_m, 0.1 * exact_m) << fraction;
    }
}

TEST(ErrorHistogram, BinsHoldTheirLowerEnd) {
    ErrorHistogram histogram;
    histogram.add(0.0);
    histogram.add(-0.99e-4);
    histogram.add(1e-4);
    histogram.add(-1.05e-4);
    histogram.add(1.11e-4);
    histogram.add(1e9);
    histogram.add(std::numeric_limits<double>::infinity());
    histogram.add(std::nan(""));
    EXPECT_EQ(histogram.count(), 7);
    EXPECT_EQ(histogram.count_in(0), 2);
    EXPECT_EQ(histogram.count_in(1), 2);
    EXPECT_EQ(histogram.count_in(2), 1);
    EXPECT_EQ(histogram.count_in(ErrorHistogram::kBins - 1), 2);
}

TEST(ErrorHistogram, NothingIsNan) {
    EXPECT_TRUE(std::isnan(ErrorHistogram().percentile(0.5)));
    ErrorHistogram beyond;
    beyond.add(5.0);
    EXPECT_NEAR(beyond.percentile(0.5), 1.0, 0.1);
}

}  // namespace
}  // namespace surefoot::eval
