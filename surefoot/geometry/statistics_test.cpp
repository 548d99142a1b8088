// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/statistics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "surefoot/core/rng.hpp"

namespace surefoot {
namespace {

TEST(Statistics, TheMedianIsTheUpperOneOfTwoInTheMiddle) {
    EXPECT_EQ(upper_median(std::vector<double>{3.0, 1.0, 2.0}), 2.0);
    EXPECT_EQ(upper_median(std::vector<double>{4.0, 1.0, 3.0, 2.0}), 3.0);
    EXPECT_EQ(upper_median(std::vector<int>{7}), 7);
}

TEST(Statistics, TheMedianIsThatOfTheSortedValues) {
    Rng rng(5);
    for (std::size_t n = 1; n < 60; ++n) {
        std::vector<double> values(n);
        for (double& value : values) value = rng.normal();
        std::vector<double> sorted = values;
        std::sort(sorted.begin(), sorted.end());
        EXPECT_EQ(upper_median_in_place(values), sorted[n / 2]) << n;
    }
}

TEST(Statistics, RobustSigmaIsThatOfTheNormalValuesAmongAFewOutliers) {
    Rng rng(6);
    std::vector<double> values(2000);
    for (double& value : values) value = 5.0 + 0.3 * rng.normal();
    for (std::size_t i = 0; i < 100; ++i) values[i] = 1e6;
    const double middle = upper_median(values);
    EXPECT_NEAR(middle, 5.0, 0.05);
    EXPECT_NEAR(robust_sigma_about(middle, values), 0.3, 0.04);
}

}  // namespace
}  // namespace surefoot
