// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/report/ticks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "surefoot/core/rng.hpp"

namespace surefoot::eval {
namespace {

TEST(Ticks, NiceBelow) {
    EXPECT_DOUBLE_EQ(nice_below(1.0), 1.0);
    EXPECT_DOUBLE_EQ(nice_below(1.99), 1.0);
    EXPECT_DOUBLE_EQ(nice_below(2.0), 2.0);
    EXPECT_DOUBLE_EQ(nice_below(4.9), 2.0);
    EXPECT_DOUBLE_EQ(nice_below(5.0), 5.0);
    EXPECT_DOUBLE_EQ(nice_below(0.1), 0.1);
    EXPECT_DOUBLE_EQ(nice_below(0.099), 0.05);
    EXPECT_DOUBLE_EQ(nice_below(1000.0), 1000.0);
}

TEST(Ticks, AreRoundNumbersWithinTheRange) {
    Rng rng(8);
    for (int trial = 0; trial < 2000; ++trial) {
        const double low = rng.uniform(-10.0, 10.0) * std::pow(10.0, double(rng.below(6)) - 3.0);
        const double high = low + std::pow(10.0, rng.uniform(-3.0, 4.0));
        const int target = 2 + int(rng.below(9));
        const Ticks ticks = nice_ticks(low, high, target);
        const double leading =
            ticks.step / std::pow(10.0, std::floor(std::log10(ticks.step) + 1e-9));
        EXPECT_TRUE(std::abs(leading - 1) < 1e-9 || std::abs(leading - 2) < 1e-9 ||
                    std::abs(leading - 5) < 1e-9)
            << ticks.step;
        EXPECT_LE(int(ticks.values.size()), target + 1);
        // The next finer step would be too many: at least target / 2.5 - 1 are left.
        EXPECT_GE(double(ticks.values.size()), std::floor(target / 2.5) - 1.0);
        std::set<std::string> labels;
        for (const double value : ticks.values) {
            EXPECT_GE(value, low - 1e-6 * ticks.step);
            EXPECT_LE(value, high + 1e-6 * ticks.step);
            EXPECT_NEAR(std::stod(ticks.label(value)), value, 1e-6 * ticks.step);
            labels.insert(ticks.label(value));
        }
        EXPECT_EQ(labels.size(), ticks.values.size());
    }
}

TEST(Ticks, LabelsOfAMap) {
    const Ticks ticks = nice_ticks(-3.0, 3.0, 8);
    std::vector<std::string> labels;
    for (const double value : ticks.values) labels.push_back(ticks.label(value));
    EXPECT_EQ(labels, (std::vector<std::string>{"-3", "-2", "-1", "0", "1", "2", "3"}));
    EXPECT_EQ(nice_ticks(0.0, 0.3, 3).label(0.1 + 0.2 - 0.3), "0.0");  // not -0.0
}

}  // namespace
}  // namespace surefoot::eval
