// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/row_runs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/stereo/stereo_targets_testing.hpp"

namespace surefoot::stereo {
namespace {

using Runs = std::vector<std::pair<int, int>>;

Runs pixel_by_pixel(const std::vector<float>& row, float same_px) {
    Runs runs;
    for (int u = 0; u < static_cast<int>(row.size()); ++u) {
        const float here = row[static_cast<std::size_t>(u)];
        if (std::isnan(here)) continue;
        const bool goes_on = u > 0 && !runs.empty() && runs.back().second == u - 1 &&
                             std::abs(here - row[static_cast<std::size_t>(u - 1)]) <= same_px;
        if (goes_on)
            runs.back().second = u;
        else
            runs.emplace_back(u, u);
    }
    return runs;
}

TEST(RowRuns, AreThoseFoundPixelByPixelOnEveryProcessor) {
    Rng rng(11);
    for (const int width : {1, 2, 15, 63, 64, 65, 127, 128, 129, 300}) {
        for (const double unknown : {0.0, 0.02, 0.3, 0.9, 1.0}) {
            // Exactly as long as the row, so that sanitizers detect reads beyond it.
            std::vector<float> row(static_cast<std::size_t>(width));
            for (float& pixel : row) {
                pixel = rng.uniform() < unknown ? std::numeric_limits<float>::quiet_NaN()
                                                : static_cast<float>(rng.uniform(5.0, 8.0));
            }
            for (const float same_px : {1.5F, std::numeric_limits<float>::infinity()}) {
                const Runs expected = pixel_by_pixel(row, same_px);
                for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
                    hwy::SetSupportedTargetsForTest(target);
                    RowRuns runs;
                    runs.find(row.data(), width, same_px);
                    Runs found;
                    runs.for_each([&](int first, int last) { found.emplace_back(first, last); });
                    EXPECT_EQ(found, expected) << hwy::TargetName(target) << width;
                }
                hwy::SetSupportedTargetsForTest(0);
            }
        }
    }
}

TEST(RowRuns, KeepNothingOfALongerRow) {
    const std::vector<float> row(200, 4.0F);
    RowRuns runs;
    runs.find(row.data(), 200, 1.0F);
    runs.find(row.data(), 70, 1.0F);
    Runs found;
    runs.for_each([&](int first, int last) { found.emplace_back(first, last); });
    EXPECT_EQ(found, (Runs{{0, 69}}));
}

}  // namespace
}  // namespace surefoot::stereo
