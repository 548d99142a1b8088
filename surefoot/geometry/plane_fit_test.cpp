// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/plane_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::geometry {
namespace {

using Points = std::vector<Eigen::Vector3d>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// z = slope_x x + slope_y y + height over a square of 2 m, with noise along z.
Points tilted_square(double slope_x, double slope_y, double height_m, double noise_m, Rng& rng) {
    Points points;
    for (int i = 0; i < 2000; ++i) {
        const double x = rng.uniform(-1.0, 1.0);
        const double y = rng.uniform(-1.0, 1.0);
        points.emplace_back(x, y, slope_x * x + slope_y * y + height_m + noise_m * rng.normal());
    }
    return points;
}

TEST(PlaneFit, NoPlaneThroughFewerThanThreePoints) {
    EXPECT_FALSE(fit_plane(Points{}));
    EXPECT_FALSE(fit_plane(Points{{1, 2, 3}}));
    EXPECT_FALSE(fit_plane(Points{{1, 2, 3}, {4, 5, 6}}));
}

TEST(PlaneFit, NoPlaneThroughALineOrASinglePlace) {
    Points line;
    for (int i = 0; i < 20; ++i) line.emplace_back(0.1 * i, 0.2 * i + 7.0, -0.3 * i);
    EXPECT_FALSE(fit_plane(line));
    EXPECT_FALSE(fit_plane(Points(10, Eigen::Vector3d(1.5, 2.5, 3.5))));
}

TEST(PlaneFit, PointsThatAreNotFiniteAreLeftOut) {
    Points points{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    points.emplace_back(kNan, 0.0, 0.0);
    points.emplace_back(0.0, kInfinity, 0.0);
    const auto fit = fit_plane(points);
    ASSERT_TRUE(fit);
    EXPECT_EQ(fit->count, 3);
    EXPECT_LE((fit->plane.normal - Eigen::Vector3d::UnitZ()).norm(), 1e-15);
    EXPECT_NEAR(fit->plane.offset_m, -1.0, 1e-15);

    EXPECT_FALSE(fit_plane(Points{{0, 0, 1}, {1, 0, 1}, {kNan, 1, 1}}));
}

TEST(PlaneFit, ExactPlaneIsFoundExactly) {
    Rng rng(1);
    const Points points = tilted_square(0.3, -0.2, 1.5, 0.0, rng);
    const auto fit = fit_plane(points);
    ASSERT_TRUE(fit);
    const Eigen::Vector3d normal = Eigen::Vector3d(-0.3, 0.2, 1.0).normalized();
    EXPECT_LE((fit->plane.normal - normal).norm(), 1e-12);
    EXPECT_NEAR(fit->plane.offset_m, -1.5 * normal.z(), 1e-12);
    EXPECT_LE(fit->rms_m, 1e-7);  // root of the rounding 1e-16 times the scatter of the square
}

TEST(PlaneFit, NoiseShowsInTheRmsAndAveragesOutOfThePlane) {
    constexpr double kNoise_m = 0.01;
    Rng rng(2);
    const auto fit = fit_plane(tilted_square(0.0, 0.0, 0.5, kNoise_m, rng));
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->rms_m, kNoise_m, 5.0 * kNoise_m / std::sqrt(2.0 * 2000.0));
    // Tilt: one sigma = noise / (sqrt(n) * scatter), scatter of [-1, 1] = 0.577.
    EXPECT_LE(fit->plane.normal.head<2>().norm(), 5.0 * kNoise_m / (std::sqrt(2000.0) * 0.577));
    EXPECT_NEAR(fit->narrow_sigma_m, 0.577, 0.02);
    EXPECT_NEAR(fit->wide_sigma_m, 0.577, 0.02);
}

TEST(PlaneFit, OrderOfThePointsDoesNotMatter) {
    Rng rng(3);
    Points points = tilted_square(0.1, 0.4, -2.0, 0.01, rng);
    const auto forward = fit_plane(points);
    std::reverse(points.begin(), points.end());
    const auto backward = fit_plane(points);
    ASSERT_TRUE(forward && backward);
    EXPECT_LE((forward->plane.normal - backward->plane.normal).norm(), 1e-13);
    EXPECT_NEAR(forward->plane.offset_m, backward->plane.offset_m, 1e-13);
}

TEST(PlaneFit, LargeCoordinatesKeepTheTilt) {
    Rng rng(4);
    Points points = tilted_square(0.2, 0.1, 0.0, 0.0, rng);
    for (auto& p : points) p += Eigen::Vector3d(5.4e5, 5.1e6, 120.0);
    const auto fit = fit_plane(points);
    ASSERT_TRUE(fit);
    const Eigen::Vector3d normal = Eigen::Vector3d(-0.2, -0.1, 1.0).normalized();
    EXPECT_LE((fit->plane.normal - normal).norm(), 1e-8);  // coordinates carry 1e-9 m
}

TEST(PlaneFit, IndicesSelectPoints) {
    Points points{{0, 0, 0}, {9, 9, 9}, {1, 0, 0}, {0, 1, 0}};
    const auto fit = fit_plane(points, std::vector<int>{0, 2, 3});
    ASSERT_TRUE(fit);
    EXPECT_EQ(fit->count, 3);
    EXPECT_NEAR(fit->plane.offset_m, 0.0, 1e-15);
}

TEST(Plane, FacingTurnsNormalAndOffsetTogether) {
    const Plane floor{Eigen::Vector3d::UnitZ(), 1.0};
    const Plane turned = floor.facing(-Eigen::Vector3d::UnitZ());
    EXPECT_EQ(turned.normal.z(), -1.0);
    const Eigen::Vector3d p(0.3, 0.4, 0.5);
    EXPECT_EQ(turned.signed_distance_m(p), -floor.signed_distance_m(p));
}

}  // namespace
}  // namespace surefoot::geometry
