// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/disparity_selection.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/stereo/stereo_targets_testing.hpp"

namespace surefoot::stereo {
namespace {

/// A row in which every pixel clearly wins at disparity 2.
Winners clear_row(int width) {
    Winners winners;
    winners.resize(width, 1);
    winners.disparity.fill(2);
    winners.cost.fill(10);
    winners.cost_below.fill(30);
    winners.cost_above.fill(30);
    winners.second_cost.fill(60);
    return winners;
}

Image<float> selected(const Winners& winners, const SelectionConfig& config = {}) {
    Serial serial;
    Image<float> disparity_px;
    select_disparities(config, winners, serial, disparity_px);
    return disparity_px;
}

TEST(Refine, VertexOfTheParabola) {
    Winners winners = clear_row(8);
    winners.cost_below.at(4, 0) = 20;   // vertex at (20 - 30) / (2 (20 + 30 - 20)) = -1/6
    winners.cost_above.at(5, 0) = 10;   // equal to the next cost: half way
    winners.cost_below.at(6, 0) = 255;  // end of the range
    const Image<float> d = selected(winners);
    EXPECT_TRUE(std::isnan(d.at(0, 0)));  // the right pixel is outside the image
    EXPECT_TRUE(std::isnan(d.at(1, 0)));
    EXPECT_FLOAT_EQ(d.at(3, 0), 2.0F);
    EXPECT_FLOAT_EQ(d.at(4, 0), 2.0F - 1.0F / 6.0F);
    EXPECT_FLOAT_EQ(d.at(5, 0), 2.5F);
    EXPECT_FLOAT_EQ(d.at(6, 0), 2.0F);
}

TEST(Refine, WhatIsNotUniqueGoes) {
    Winners winners = clear_row(8);
    winners.cost.at(4, 0) = 95;
    winners.second_cost.at(4, 0) = 100;  // just unique with 5 %
    winners.cost.at(5, 0) = 96;
    winners.second_cost.at(5, 0) = 100;
    const Image<float> d = selected(winners);
    EXPECT_FALSE(std::isnan(d.at(4, 0)));
    EXPECT_TRUE(std::isnan(d.at(5, 0)));
}

TEST(Refine, TheCheaperClaimOnARightPixelWins) {
    Winners winners = clear_row(12);
    winners.disparity.at(9, 0) = 5;  // claims right pixel 4, as pixel 6 does with disparity 2
    winners.cost.at(9, 0) = 5;
    const Image<float> d = selected(winners);
    EXPECT_FALSE(std::isnan(d.at(9, 0)));
    EXPECT_TRUE(std::isnan(d.at(6, 0)));
    EXPECT_FALSE(std::isnan(d.at(7, 0)));
    winners.cost.at(9, 0) = 15;
    EXPECT_TRUE(std::isnan(selected(winners).at(9, 0)));
    EXPECT_FALSE(std::isnan(selected(winners).at(6, 0)));
}

TEST(Refine, InfinitelyFarIsNoDepth) {
    Winners winners = clear_row(4);
    winners.disparity.fill(0);
    const Image<float> d = selected(winners);
    for (int u = 0; u < 4; ++u) EXPECT_TRUE(std::isnan(d.at(u, 0)));
}

/// The definition of select_disparities, pixel by pixel.
float selected_plainly(const SelectionConfig& config, const Winners& w, int u, int v) {
    const int d = w.disparity.at(u, v);
    const int cost = w.cost.at(u, v);
    if (d == 0 || d > u) return kNanF;
    if (w.second_cost.at(u, v) * (100 - config.uniqueness_percent) < 100 * cost) return kNanF;
    int claimed = d;
    int cheapest = cost;
    for (int other = 0; other < w.cost.width(); ++other) {
        const int its_d = w.disparity.at(other, v);
        if (other - its_d != u - d) continue;
        const int its_cost = w.cost.at(other, v);
        if (its_cost > cheapest || (its_cost == cheapest && its_d >= claimed)) continue;
        claimed = its_d;
        cheapest = its_cost;
    }
    if (std::abs(claimed - d) > config.left_right_px) return kNanF;
    const int below = w.cost_below.at(u, v);
    const int above = w.cost_above.at(u, v);
    const int curvature = below + above - 2 * cost;
    if (below == 255 || above == 255 || curvature <= 0) return static_cast<float>(d);
    return static_cast<float>(d) +
           static_cast<float>(below - above) / static_cast<float>(2 * curvature);
}

TEST(Refine, FollowsTheRuleOnEveryProcessor) {
    Rng rng(4);
    const SelectionConfig config{10, 1};
    for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {70, 40}}) {
        Winners winners;
        winners.resize(width, height);
        const auto byte = [&](double low, double high) {
            return static_cast<std::uint8_t>(rng.uniform(low, high));
        };
        for (std::size_t i = 0; i < winners.cost.size(); ++i) {
            winners.disparity.data()[i] = byte(0.0, 12.0);
            winners.cost.data()[i] = byte(0.0, 120.0);
            winners.cost_below.data()[i] = rng.uniform() < 0.1 ? 255 : byte(0.0, 250.0);
            winners.cost_above.data()[i] = rng.uniform() < 0.1 ? 255 : byte(0.0, 250.0);
            winners.second_cost.data()[i] = byte(60.0, 256.0);
        }
        for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
            hwy::SetSupportedTargetsForTest(target);
            const Image<float> out = selected(winners, config);
            for (int v = 0; v < height; ++v) {
                for (int u = 0; u < width; ++u) {
                    const float expected = selected_plainly(config, winners, u, v);
                    if (std::isnan(expected))
                        ASSERT_TRUE(std::isnan(out.at(u, v))) << u << ", " << v;
                    else
                        ASSERT_EQ(out.at(u, v), expected) << u << ", " << v;
                }
            }
        }
        hwy::SetSupportedTargetsForTest(0);
    }
}

TEST(MedianOfRow, IsTheMiddleOfNineOnEveryProcessor) {
    Rng rng(3);
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {7, 3}, {70, 9}}) {
        Image<float> in(width, height);
        for (std::size_t i = 0; i < in.size(); ++i) {
            in.data()[i] = rng.uniform() < 0.35 ? std::numeric_limits<float>::quiet_NaN()
                                                : static_cast<float>(rng.uniform(1.0, 60.0));
        }
        for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
            hwy::SetSupportedTargetsForTest(target);
            Image<float> out(width, height);
            std::vector<float> scratch;
            for (int v = 0; v < height; ++v) median_of_row(in, v, scratch, out.row(v));
            for (int v = 0; v < height; ++v) {
                for (int u = 0; u < width; ++u) {
                    std::vector<float> nine;
                    for (int k = 0; k < 9; ++k) {
                        const float value = in.at(std::clamp(u + k % 3 - 1, 0, width - 1),
                                                  std::clamp(v + k / 3 - 1, 0, height - 1));
                        nine.push_back(std::isnan(value) ? -1.0F : value);
                    }
                    std::sort(nine.begin(), nine.end());
                    if (nine[4] < 0.0F)
                        ASSERT_TRUE(std::isnan(out.at(u, v)));
                    else
                        ASSERT_EQ(out.at(u, v), nine[4]) << u << ", " << v;
                }
            }
        }
        hwy::SetSupportedTargetsForTest(0);
    }
}

}  // namespace
}  // namespace surefoot::stereo
