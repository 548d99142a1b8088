// SPDX-License-Identifier: Apache-2.0
// Rational lenses whose image turns back before it reaches the corners, and others.
#include "surefoot/calibration/growing_image.hpp"

#include <gtest/gtest.h>

#include <array>

namespace surefoot::calibration {
namespace {

constexpr ImageSize kSize{320, 240};

using Lens = std::array<double, 12>;  ///< fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6

/// Its image reaches the farthest corner, 160 px across and 122 px up, at tan(angle) = 1.422.
constexpr Lens kWide{210.0, 210.5, 159.0, 122.0, 0.51, -0.6, 0.0, 0.0, 0.3, 0.8, -0.6, 0.35};
/// What ten boards that left the corners out made of it.
constexpr Lens kTurning{
    209.938, 210.441, 159.033, 122.010, -0.052, 0.055, 0.0, 0.0, 0.077, 0.234, -0.068, 0.235};

double radial(const Lens& lens, double r) {
    const double s = r * r;
    return r * (1.0 + s * (lens[4] + s * (lens[5] + s * lens[8]))) /
           (1.0 + s * (lens[9] + s * (lens[10] + s * lens[11])));
}

TEST(GrowingImage, GrowthIsTheSlopeOfTheProfile) {
    constexpr double kStep = 1e-5;
    constexpr double kDifferences = 1e-8;  // of the second order in the step, and rounding
    for (const Lens& lens : {kWide, kTurning}) {
        for (const double r : {0.1, 0.7, 1.3, 2.2}) {
            double growth = 0.0;
            ASSERT_TRUE(growth_at(lens.data(), r, &growth));
            EXPECT_NEAR(growth,
                        (radial(lens, r + kStep) - radial(lens, r - kStep)) / (2.0 * kStep),
                        kDifferences);
        }
    }
}

TEST(GrowingImage, ALensThatReachesItsCornersDoesNotTurnBack) {
    const GrowthCheck check = check_growth(kWide.data(), kSize);
    EXPECT_FALSE(check.turns_back);
    EXPECT_NEAR(growth_place(check.places - 1), 1.422, kGrowthStep);
}

TEST(GrowingImage, OneThatTurnsBackBeforeIsNoticed) {
    EXPECT_TRUE(check_growth(kTurning.data(), kSize).turns_back);
    // A smaller image ends before.
    Lens cropped = kTurning;
    cropped[2] = 100.0;
    cropped[3] = 75.0;
    EXPECT_FALSE(check_growth(cropped.data(), {201, 151}).turns_back);
}

TEST(GrowingImage, APoleLiesBeyondEveryCorner) {
    Lens pole = kWide;
    pole[4] = pole[5] = pole[8] = pole[9] = pole[10] = 0.0;
    pole[11] = -8.0;  // at r = 0.71, where the image has gone to infinity
    EXPECT_FALSE(check_growth(pole.data(), kSize).turns_back);
    double growth = 0.0;
    EXPECT_FALSE(growth_at(pole.data(), 0.8, &growth));
}

}  // namespace
}  // namespace surefoot::calibration
