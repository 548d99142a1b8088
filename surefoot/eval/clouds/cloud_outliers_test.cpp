// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/clouds/cloud_outliers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/eval/clouds/clouds_testing.hpp"

namespace surefoot::eval {
namespace {

using testing::Points;

/// Reference implementation: compares every point with every other point.
std::vector<bool> kept_by_definition(const Points& points_m, const OutlierConfig& config) {
    std::vector<double> means_m;
    for (std::size_t i = 0; i < points_m.size(); ++i) {
        std::vector<double> d_m;
        for (std::size_t k = 0; k < points_m.size(); ++k) {
            if (k != i) d_m.push_back((points_m[k] - points_m[i]).cast<double>().norm());
        }
        std::sort(d_m.begin(), d_m.end());
        const std::size_t n =
            std::min<std::size_t>(static_cast<std::size_t>(config.others), d_m.size());
        double sum_m = 0.0;
        for (std::size_t k = 0; k < n; ++k) sum_m += d_m[k];
        means_m.push_back(n > 0 ? sum_m / static_cast<double>(n) : 0.0);
    }
    double mean_m = 0.0;
    for (const double d_m : means_m) mean_m += d_m / static_cast<double>(means_m.size());
    double var_m2 = 0.0;
    for (const double d_m : means_m)
        var_m2 += (d_m - mean_m) * (d_m - mean_m) / static_cast<double>(means_m.size());
    std::vector<bool> kept;
    for (const double d_m : means_m)
        kept.push_back(d_m <= mean_m + config.sigmas * std::sqrt(var_m2));
    return kept;
}

TEST(Outliers, AreThoseOfTheDefinition) {
    Points points_m = testing::steps(1500, 1);
    Rng rng(2);
    for (int i = 0; i < 15; ++i)
        points_m[rng.below(points_m.size())] +=
            Eigen::Vector3f(0.0F, 0.0F, 0.1F + 0.1F * static_cast<float>(i));
    points_m[7] = points_m[8];
    for (const OutlierConfig config :
         {OutlierConfig{6, 4.0}, OutlierConfig{1, 1.0}, OutlierConfig{50, 2.0}}) {
        const std::vector<bool> kept = kept_by_definition(points_m, config);
        EXPECT_GT(std::count(kept.begin(), kept.end(), false), 3);
        Threads threads(2);
        const OutlierFilter filter(geometry::KdTree(points_m), config, threads);
        for (std::size_t i = 0; i < points_m.size(); ++i)
            EXPECT_EQ(filter.keeps(points_m[i]), kept[i]) << "point " << i;
        EXPECT_FALSE(filter.keeps({9.0F, 9.0F, 9.0F})) << "is no point of the cloud";
    }
}

TEST(Outliers, FewPointsAndOnePlace) {
    const OutlierFilter none(geometry::KdTree(Points{}), {});
    EXPECT_FALSE(none.keeps({0.0F, 0.0F, 0.0F}));
    EXPECT_TRUE(OutlierFilter(geometry::KdTree(Points(1, {1, 2, 3})), {}).keeps({1, 2, 3}));
    EXPECT_TRUE(OutlierFilter(geometry::KdTree(Points{{1, 2, 3}, {4, 5, 6}}), {}).keeps({4, 5, 6}));
    const OutlierFilter same(geometry::KdTree(Points(5000, {1, 2, 3})), {});
    EXPECT_TRUE(same.keeps({1, 2, 3}));
    EXPECT_EQ(same.limit_m(), 0.0);
}

}  // namespace
}  // namespace surefoot::eval
