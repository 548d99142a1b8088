// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/ransac_plane.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "surefoot/core/unknown.hpp"

namespace surefoot::geometry {
namespace {

using Points = std::vector<Eigen::Vector3d>;

const Eigen::Vector3d kNormal = Eigen::Vector3d(-0.1, 0.05, 1.0).normalized();
constexpr double kOffset_m = 0.9;

/// Points of a known plane with noise, then outliers spread over a box.
Points plane_with_outliers(int inliers, int outliers, double noise_m, Rng& rng) {
    Points points;
    for (int i = 0; i < inliers; ++i) {
        const double x = rng.uniform(-2.0, 2.0);
        const double y = rng.uniform(-2.0, 2.0);
        const double z = -(kOffset_m + kNormal.x() * x + kNormal.y() * y) / kNormal.z();
        points.emplace_back(Eigen::Vector3d(x, y, z) + noise_m * rng.normal() * kNormal);
    }
    for (int i = 0; i < outliers; ++i) {
        points.emplace_back(rng.uniform(-2.0, 2.0), rng.uniform(-2.0, 2.0), rng.uniform(-3.0, 3.0));
    }
    return points;
}

TEST(RansacPlane, TooFewOrCollinearPointsHaveNoPlane) {
    Rng rng(1);
    const RansacPlaneOptions options;
    EXPECT_FALSE(ransac_plane(Points{}, options, rng));
    EXPECT_FALSE(ransac_plane(Points{{1, 2, 3}}, options, rng));
    EXPECT_FALSE(ransac_plane(Points{{1, 2, 3}, {2, 2, 3}}, options, rng));
    Points line;
    for (int i = 0; i < 50; ++i) line.emplace_back(0.25 * i, 0.0, 0.0);
    EXPECT_FALSE(ransac_plane(line, options, rng));
    EXPECT_FALSE(ransac_plane(Points(20, Eigen::Vector3d(kNan, 0, 0)), options, rng));
}

TEST(RansacPlane, EndsWhenThePlaneThatIsWantedWouldHaveBeenFound) {
    Rng data_rng(1);
    const Points points = plane_with_outliers(100, 900, 0.005, data_rng);
    RansacPlaneOptions options;
    options.tolerance_m = 0.02;
    const auto iterations = [&](double least_inlier_ratio) {
        options.least_inlier_ratio = least_inlier_ratio;
        Rng rng(2);
        return ransac_plane(points, options, rng)->iterations;
    };
    EXPECT_EQ(iterations(0.0), options.max_iterations);
    // log(1 - confidence) / log(1 - ratio^3), plus the first draw, which does not count yet.
    EXPECT_NEAR(iterations(0.5), 69, 1);
    EXPECT_NEAR(iterations(0.3), 336, 1);
    EXPECT_EQ(iterations(1.0), 1);
}

TEST(RansacPlane, KnownPlaneIsFoundAmongHalfOutliersForManySeeds) {
    constexpr double kNoise_m = 0.005;
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        Rng data_rng(seed);
        const Points points = plane_with_outliers(500, 500, kNoise_m, data_rng);
        RansacPlaneOptions options;
        options.tolerance_m = 0.02;
        Rng rng(seed + 1000);
        const auto found = ransac_plane(points, options, rng);
        ASSERT_TRUE(found) << "seed " << seed;
        // One sigma of the tilt is noise / (sqrt(500) * 1.15 m) = 0.2 mrad; the 3-7 outliers that
        // lie within the tolerance add less than 1 mrad.
        EXPECT_LE((found->fit.plane.normal - kNormal).norm(), 2e-3) << "seed " << seed;
        EXPECT_NEAR(found->fit.plane.offset_m, kOffset_m, 2e-3) << "seed " << seed;
        EXPECT_GE(found->inliers.size(), 495U) << "seed " << seed;
        EXPECT_NEAR(found->inlier_ratio, 0.5, 0.02) << "seed " << seed;
    }
}

TEST(RansacPlane, InliersAreExactlyThePointsWithinTheTolerance) {
    Rng data_rng(5);
    Points points = plane_with_outliers(300, 100, 0.01, data_rng);
    points.emplace_back(kNan, kNan, kNan);
    RansacPlaneOptions options;
    options.tolerance_m = 0.03;
    options.max_refinements = 50;
    Rng rng(6);
    const auto found = ransac_plane(points, options, rng);
    ASSERT_TRUE(found);
    std::vector<int> expected;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (std::abs(found->fit.plane.signed_distance_m(points[i])) <= options.tolerance_m) {
            expected.push_back(static_cast<int>(i));
        }
    }
    EXPECT_EQ(found->inliers, expected);
    EXPECT_EQ(found->fit.count, static_cast<int>(expected.size()));
}

TEST(RansacPlane, SameSeedGivesTheSameBytes) {
    Rng data_rng(7);
    const Points points = plane_with_outliers(300, 300, 0.01, data_rng);
    Rng first_rng(8);
    Rng second_rng(8);
    const auto first = ransac_plane(points, {}, first_rng);
    const auto second = ransac_plane(points, {}, second_rng);
    ASSERT_TRUE(first && second);
    EXPECT_EQ(first->fit.plane.normal, second->fit.plane.normal);
    EXPECT_EQ(first->fit.plane.offset_m, second->fit.plane.offset_m);
    EXPECT_EQ(first->inliers, second->inliers);
}

TEST(RansacPlane, OrderOfThePointsDoesNotChangeAClearPlane) {
    Rng data_rng(9);
    Points points = plane_with_outliers(800, 100, 0.003, data_rng);
    Rng rng(10);
    const auto forward = ransac_plane(points, {}, rng);
    std::reverse(points.begin(), points.end());
    const auto backward = ransac_plane(points, {}, rng);
    ASSERT_TRUE(forward && backward);
    // The refinement ends with the same inliers for every starting triple.
    EXPECT_EQ(forward->inliers.size(), backward->inliers.size());
    EXPECT_LE((forward->fit.plane.normal - backward->fit.plane.normal).norm(), 1e-12);
}

TEST(RansacPlane, ConeExcludesTheLargerWall) {
    Rng data_rng(11);
    Points points;
    for (int i = 0; i < 300; ++i) {  // floor z = -1
        points.emplace_back(data_rng.uniform(0.0, 2.0), data_rng.uniform(-1.0, 1.0), -1.0);
    }
    for (int i = 0; i < 900; ++i) {  // wall x = 2
        points.emplace_back(2.0, data_rng.uniform(-1.0, 1.0), data_rng.uniform(-1.0, 2.0));
    }
    Rng rng(12);
    const auto largest = ransac_plane(points, {}, rng);
    ASSERT_TRUE(largest);
    EXPECT_GT(std::abs(largest->fit.plane.normal.x()), 0.99);

    RansacPlaneOptions options;
    options.cone = NormalCone{Eigen::Vector3d(0.0, 0.0, -7.0), 0.3};
    const auto floor = ransac_plane(points, options, rng);
    ASSERT_TRUE(floor);
    EXPECT_LT(floor->fit.plane.normal.z(), -0.99) << "the normal takes the side of the direction";
    EXPECT_NEAR(floor->fit.plane.offset_m, -1.0, 0.02);
}

TEST(RansacPlane, CleanDataEndEarly) {
    Rng data_rng(13);
    const Points clean = plane_with_outliers(500, 0, 0.001, data_rng);
    const Points dirty = plane_with_outliers(100, 400, 0.001, data_rng);
    Rng rng(14);
    const auto easy = ransac_plane(clean, {}, rng);
    const auto hard = ransac_plane(dirty, {}, rng);
    ASSERT_TRUE(easy && hard);
    EXPECT_LE(easy->iterations, 20);
    EXPECT_GE(hard->iterations, 200);
    EXPECT_LE(hard->iterations, RansacPlaneOptions{}.max_iterations);
}

TEST(RansacPlane, PointsMayHaveTolerancesOfTheirOwn) {
    // Two levels 60 mm apart, the far one noisy. With one tolerance for all points, a slope between
    // the levels has the most inliers.
    Rng rng(9);
    Points points;
    std::vector<double> tolerances_m;
    for (int i = 0; i < 900; ++i) {
        const bool is_near = i % 3 != 0;
        const double sigma_m = is_near ? 0.003 : 0.01;
        points.emplace_back(rng.uniform(is_near ? 0.0 : 1.0, is_near ? 1.0 : 2.0),
                            rng.uniform(-1.0, 1.0),
                            (is_near ? 0.0 : 0.06) + sigma_m * rng.normal());
        tolerances_m.push_back(3.0 * sigma_m);
    }
    RansacPlaneOptions options;
    options.tolerance_m = 0.06;
    const auto across = ransac_plane(points, options, rng);
    ASSERT_TRUE(across);
    EXPECT_GT(across->fit.plane.normal.head<2>().norm(), 0.02);
    options.tolerance_of_m = tolerances_m;
    const auto own = ransac_plane(points, options, rng);
    ASSERT_TRUE(own);
    EXPECT_LT(own->fit.plane.normal.head<2>().norm(), 0.01);
    EXPECT_NEAR(own->fit.plane.offset_m, 0.0, 0.004);
}

}  // namespace
}  // namespace surefoot::geometry
