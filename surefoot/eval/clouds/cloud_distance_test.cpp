// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/clouds/cloud_distance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/eval/clouds/clouds_testing.hpp"

namespace surefoot::eval {
namespace {

using testing::Points;

TEST(CloudDistance, IsThatOfTheNearestPoint) {
    const Points reference_m = testing::steps(3000, 1);
    const Points compared_m = testing::steps(2000, 2);
    const auto distances_m = cloud_distances_m(geometry::KdTree(reference_m), compared_m);
    ASSERT_EQ(distances_m.size(), compared_m.size());
    for (std::size_t i = 0; i < compared_m.size(); ++i) {
        float nearest_m = std::numeric_limits<float>::infinity();
        for (const auto& p_m : reference_m)
            nearest_m = std::min(nearest_m, (p_m - compared_m[i]).norm());
        EXPECT_NEAR(distances_m[i], nearest_m, 1e-6F * nearest_m) << i;
    }
    EXPECT_TRUE(cloud_distances_m(geometry::KdTree(reference_m), {}).empty());
}

TEST(CloudDistance, ACloudLiesOnItself) {
    const Points points_m = testing::steps(30000, 3);
    for (const float d_m : cloud_distances_m(geometry::KdTree(points_m), points_m))
        EXPECT_EQ(d_m, 0.0F);
}

TEST(CloudDistance, SameBytesForAnyNumberOfThreads) {
    const Points reference_m = testing::steps(50000, 4);
    const Points compared_m = testing::steps(50000, 5);
    Backwards backwards;
    Threads threads(3);
    const auto one = cloud_distances_m(geometry::KdTree(reference_m), compared_m);
    EXPECT_EQ(one, cloud_distances_m(geometry::KdTree(reference_m), compared_m, backwards));
    EXPECT_EQ(one, cloud_distances_m(geometry::KdTree(reference_m, threads), compared_m, threads));
}

TEST(DistanceFigures, ByHand) {
    const DistanceFigures f = distance_figures(std::vector<float>{3.0F, kNanF, -1.0F, 0.0F, 2.0F});
    EXPECT_EQ(f.count, 4);
    EXPECT_DOUBLE_EQ(f.mean_m, 1.0);
    EXPECT_DOUBLE_EQ(f.std_m, std::sqrt(10.0 / 4.0));
    EXPECT_DOUBLE_EQ(f.rms_m, std::sqrt(14.0 / 4.0));
    EXPECT_DOUBLE_EQ(f.least_m, -1.0);
    EXPECT_DOUBLE_EQ(f.most_m, 3.0);
    EXPECT_DOUBLE_EQ(f.p50_m, 1.0);         // between 0 and 2
    EXPECT_NEAR(f.p90_m, 2.7, 1e-12);       // rank 2.7 of -1 0 2 3
    EXPECT_DOUBLE_EQ(f.median_abs_m, 1.5);  // between 1 and 2
}

TEST(DistanceFigures, NothingOfNothing) {
    const DistanceFigures f = distance_figures({});
    EXPECT_EQ(f.count, 0);
    EXPECT_TRUE(std::isnan(f.mean_m) && std::isnan(f.std_m) && std::isnan(f.p90_abs_m));
    EXPECT_EQ(distance_figures(std::vector<float>{2.0F}).p99_m, 2.0);
}

}  // namespace
}  // namespace surefoot::eval
