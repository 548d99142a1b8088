// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/clouds/m3c2.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/eval/clouds/clouds_testing.hpp"

namespace surefoot::eval {
namespace {

using geometry::KdTree;
using testing::Points;

/// A sloping plane, z = slope x + height, 2 x 2 m.
Points slope(std::size_t count, double slope, double height_m, double noise_m, std::uint64_t seed) {
    Rng rng(seed);
    Points points_m;
    for (std::size_t i = 0; i < count; ++i) {
        const double x_m = rng.uniform(-1.0, 1.0);
        points_m.emplace_back(static_cast<float>(x_m),
                              static_cast<float>(rng.uniform(-1.0, 1.0)),
                              static_cast<float>(slope * x_m + height_m + noise_m * rng.normal()));
    }
    return points_m;
}

TEST(M3c2, ByHand) {
    // Within 25 mm of the core point and 0.1 m above or below it; the last point of each is not.
    const Points reference_m = {
        {0.0F, 0.0F, 0.01F}, {0.02F, 0.0F, -0.01F}, {0.0F, 0.025F, 0.0F}, {0.026F, 0.0F, 0.0F}};
    const Points compared_m = {
        {0.0F, 0.0F, 0.05F}, {0.0F, -0.02F, 0.07F}, {0.01F, 0.0F, 0.06F}, {0.0F, 0.0F, 0.101F}};
    M3c2Config config;
    config.min_points = 3;
    config.registration_error_m = 0.002;
    const auto values = m3c2(KdTree(reference_m), KdTree(compared_m), Points(1, {0, 0, 0}), config);
    ASSERT_EQ(values.size(), 1U);
    const M3c2Value& v = values.front();
    EXPECT_EQ(v.count_reference, 3);
    EXPECT_EQ(v.count_compared, 3);
    constexpr double kFloat_m = 1e-8;
    EXPECT_NEAR(v.distance_m, 0.06, kFloat_m);
    const double std_m = std::sqrt(0.0002 / 3.0);
    EXPECT_NEAR(v.std_reference_m, std_m, kFloat_m);
    EXPECT_NEAR(v.std_compared_m, std_m, kFloat_m);
    EXPECT_NEAR(v.lod95_m, 1.96 * (std::sqrt(2.0 * std_m * std_m / 3.0) + 0.002), kFloat_m);
    EXPECT_TRUE(v.significant);

    config.min_points = 4;
    const M3c2Value few =
        m3c2(KdTree(reference_m), KdTree(compared_m), Points(1, {0, 0, 0}), config).front();
    EXPECT_NEAR(few.distance_m, 0.06, kFloat_m);
    EXPECT_TRUE(std::isnan(few.lod95_m));
    EXPECT_FALSE(few.significant);
}

TEST(M3c2, NoDistanceWhereACloudHasNoPoint) {
    const Points here = slope(1000, 0.0, 0.0, 0.001, 1);
    const Points nowhere(3, {50.0F, 0.0F, 0.0F});
    for (const auto normals : {M3c2Normals::vertical, M3c2Normals::pca}) {
        M3c2Config config;
        config.normals = normals;
        const M3c2Value v = m3c2(KdTree(here), KdTree(nowhere), Points(1, {0, 0, 0}), config)[0];
        EXPECT_TRUE(std::isnan(v.distance_m) && std::isnan(v.std_compared_m));
        EXPECT_FALSE(v.significant);
        EXPECT_EQ(
            m3c2(KdTree(here), KdTree(Points{}), Points(1, {0, 0, 0}), config)[0].count_compared,
            0);
    }
    // Without a surface there is no normal to go along.
    M3c2Config config;
    config.normals = M3c2Normals::pca;
    EXPECT_TRUE(std::isnan(
        m3c2(KdTree(nowhere), KdTree(here), Points(1, {50, 0, 0}), config)[0].normal.x()));
}

TEST(M3c2, NormalsFollowTheSurface) {
    // 30 deg: what is 20 mm higher is 17.3 mm away.
    const double rise = std::tan(M_PI / 6.0);
    const KdTree reference(slope(40000, rise, 0.0, 0.001, 2));
    const KdTree compared(slope(40000, rise, 0.02, 0.001, 3));
    M3c2Config config;
    config.projection_diameter_m = 0.2;
    const Points core(1, {0, 0, 0});
    // Some 310 points of 1 mm noise; along z the cylinder cuts the slope, across it it does not.
    EXPECT_NEAR(m3c2(reference, compared, core, config)[0].distance_m, 0.02, 0.008);
    config.normals = M3c2Normals::pca;
    config.normal_diameter_m = 0.3;
    const M3c2Value along = m3c2(reference, compared, core, config)[0];
    EXPECT_NEAR(along.distance_m, 0.02 * std::cos(M_PI / 6.0), 0.0003);
    EXPECT_NEAR(along.normal.z(), std::cos(M_PI / 6.0), 1e-3);
    EXPECT_NEAR(along.std_reference_m, 0.001 * std::cos(M_PI / 6.0), 0.0002);
    EXPECT_TRUE(along.significant);
    config.registration_error_m = 0.02;
    EXPECT_FALSE(m3c2(reference, compared, core, config)[0].significant);
}

TEST(M3c2, LevelOfDetectionHoldsForNineteenOfTwenty) {
    const KdTree reference(slope(100000, 0.0, 0.0, 0.002, 4));
    const KdTree compared(slope(100000, 0.0, 0.0, 0.002, 5));
    Points cores_m;
    for (int x = -9; x <= 9; ++x) {
        for (int y = -9; y <= 9; ++y)
            cores_m.emplace_back(0.1F * static_cast<float>(x), 0.1F * static_cast<float>(y), 0.0F);
    }
    int significant = 0;
    for (const M3c2Value& v : m3c2(reference, compared, cores_m, {})) significant += v.significant;
    // 361 cylinders that share nothing: 18 expected, sigma 4.1.
    EXPECT_GT(significant, 18 - 3 * 4.1);
    EXPECT_LT(significant, 18 + 3 * 4.1);
}

TEST(M3c2, SameValuesForAnyNumberOfThreads) {
    const Points cores_m = testing::steps(1000, 6);
    M3c2Config config;
    config.normals = M3c2Normals::pca;
    const KdTree reference(testing::steps(20000, 7));
    const KdTree compared(testing::steps(20000, 8));
    Threads threads(3);
    const auto one = m3c2(reference, compared, cores_m, config);
    const auto three = m3c2(reference, compared, cores_m, config, threads);
    int known = 0;
    for (std::size_t i = 0; i < one.size(); ++i) {
        known += std::isnan(one[i].distance_m) ? 0 : 1;
        if (std::isnan(one[i].distance_m)) continue;
        EXPECT_EQ(one[i].distance_m, three[i].distance_m);
        EXPECT_EQ(one[i].count_compared, three[i].count_compared);
    }
    EXPECT_GT(known, 900);
}

}  // namespace
}  // namespace surefoot::eval
