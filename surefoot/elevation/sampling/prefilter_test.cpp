// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/sampling/prefilter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "surefoot/core/rng.hpp"

namespace surefoot::elevation {
namespace {

std::vector<GridPoint> random_cloud(Rng& rng, int count, double edge_m) {
    std::vector<GridPoint> points;
    for (int i = 0; i < count; ++i) {
        points.push_back({static_cast<float>(rng.uniform(-edge_m, edge_m)),
                          static_cast<float>(rng.uniform(-edge_m, edge_m)),
                          static_cast<float>(rng.uniform(-edge_m, edge_m)),
                          static_cast<float>(i)});
    }
    return points;
}

/// Returns the numbers of the points, which the test stores in their variances.
std::vector<int> numbers(std::span<const GridPoint> points) {
    std::vector<int> result;
    for (const GridPoint& point : points) result.push_back(static_cast<int>(point.var_m2));
    return result;
}

TEST(Prefilter, CutsHaveTheirOwnSwitchesAndNanDoesNotPass) {
    PrefilterConfig config;
    EXPECT_TRUE(is_in_range(config, 1.0));
    EXPECT_FALSE(is_in_range(config, 0.29));
    EXPECT_FALSE(is_in_range(config, 20.1));
    EXPECT_FALSE(is_in_range(config, std::numeric_limits<double>::quiet_NaN()));
    EXPECT_FALSE(is_in_height(config, 1.01));
    EXPECT_TRUE(is_in_height(config, -30.0)) << "a drop";
    EXPECT_TRUE(is_in_height(config, -1.0));
    config.range = false;
    config.height = false;
    EXPECT_TRUE(is_in_range(config, 100.0));
    EXPECT_TRUE(is_in_height(config, 100.0));
}

TEST(Prefilter, DownSamplingKeepsThePointNearestToEachCubesCentre) {
    constexpr double kEdge_m = 0.05;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Rng rng(seed);
        std::vector<GridPoint> points = random_cloud(rng, 2000, 0.3);
        std::map<std::array<int, 3>, std::pair<double, int>> best;
        for (const GridPoint& point : points) {
            const double p[3] = {static_cast<double>(point.x_m),
                                 static_cast<double>(point.y_m),
                                 static_cast<double>(point.z_m)};
            std::array<int, 3> cube{};
            double off_sq = 0.0;
            for (std::size_t i = 0; i < 3; ++i) {
                cube[i] = static_cast<int>(std::floor(p[i] / kEdge_m));
                const double off_m = p[i] - (cube[i] + 0.5) * kEdge_m;
                off_sq += off_m * off_m;
            }
            const auto [entry, is_new] =
                best.try_emplace(cube, off_sq, static_cast<int>(point.var_m2));
            if (!is_new && off_sq < entry->second.first) {
                entry->second = {off_sq, static_cast<int>(point.var_m2)};
            }
        }
        std::vector<int> expected;
        for (const auto& [cube, winner] : best) expected.push_back(winner.second);
        std::sort(expected.begin(), expected.end());  // the filter keeps the order of the points
        CloudFilter filter;
        const std::size_t kept = filter.down_sample(kEdge_m, points);
        EXPECT_EQ(numbers(std::span(points).first(kept)), expected) << "seed " << seed;
    }
}

TEST(Prefilter, OutlierRemovalMatchesTheBruteForceCount) {
    constexpr double kRadius_m = 0.25;
    CloudFilter filter;  // one for all rounds: its tables are reused
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Rng rng(seed);
        std::vector<GridPoint> points = random_cloud(rng, 400, 1.0);
        std::vector<int> expected;
        for (const GridPoint& a : points) {
            int neighbours = -1;  // itself
            for (const GridPoint& b : points) {
                const float dx = a.x_m - b.x_m;
                const float dy = a.y_m - b.y_m;
                const float dz = a.z_m - b.z_m;
                if (dx * dx + dy * dy + dz * dz <= 0.0625F) ++neighbours;
            }
            if (neighbours >= 4) expected.push_back(static_cast<int>(a.var_m2));
        }
        const std::size_t kept = filter.remove_outliers(kRadius_m, 4, points);
        EXPECT_EQ(numbers(std::span(points).first(kept)), expected) << "seed " << seed;
        EXPECT_GT(kept, 0U);
        EXPECT_LT(kept, points.size());
    }
}

TEST(Prefilter, EmptyAndSingleClouds) {
    CloudFilter filter;
    std::vector<GridPoint> points;
    EXPECT_EQ(filter.down_sample(0.01, points), 0U);
    EXPECT_EQ(filter.remove_outliers(0.25, 1, points), 0U);
    points = {{0.1F, 0.1F, 0.1F, 0.0F}};
    EXPECT_EQ(filter.down_sample(0.01, points), 1U);
    EXPECT_EQ(filter.remove_outliers(0.25, 1, points), 0U);
}

}  // namespace
}  // namespace surefoot::elevation
