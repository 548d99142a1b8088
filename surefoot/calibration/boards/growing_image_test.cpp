// SPDX-License-Identifier: Apache-2.0
// Tests lenses whose image folds back before the corners, and lenses whose image does not.
#include "surefoot/calibration/boards/growing_image.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace surefoot::calibration {
namespace {

constexpr ImageSize kSize{320, 240};

using Lens = std::array<double, 12>;  ///< fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6

/// The image reaches the farthest corner, 160 px across and 122 px up, at tan(angle) = 1.422.
constexpr Lens kWide{210.0, 210.5, 159.0, 122.0, 0.51, -0.6, 0.0, 0.0, 0.3, 0.8, -0.6, 0.35};
/// An estimate of kWide from ten boards that did not cover the corners.
constexpr Lens kTurning{
    209.938, 210.441, 159.033, 122.010, -0.052, 0.055, 0.0, 0.0, 0.077, 0.234, -0.068, 0.235};

using Fisheye = std::array<double, 8>;  ///< fx fy cx cy k1 k2 k3 k4

/// The image reaches the farthest corner, 161 px across and 122 px up, at 1.78 rad.
constexpr Fisheye kNearlyHalf{120.0, 120.3, 158.5, 122.0, 0.0121, 0.0056, -0.0061, 0.0005};
/// An estimate whose last coefficients are not determined by boards: it folds back at 1.45 rad.
constexpr Fisheye kTurningFisheye{120.0, 120.3, 158.5, 122.0, 0.02, -0.02, 0.02, -0.0112};

double angular(const Fisheye& lens, double theta) {
    const double s = theta * theta;
    return theta * (1.0 + s * (lens[4] + s * (lens[5] + s * (lens[6] + s * lens[7]))));
}

double radial(const Lens& lens, double r) {
    const double s = r * r;
    return r * (1.0 + s * (lens[4] + s * (lens[5] + s * lens[8]))) /
           (1.0 + s * (lens[9] + s * (lens[10] + s * lens[11])));
}

TEST(GrowingImage, GrowthIsTheSlopeOfTheProfile) {
    constexpr double kStep = 1e-5;
    constexpr double kDifferences = 1e-8;  // second order in the step, plus rounding
    for (const Lens& lens : {kWide, kTurning}) {
        for (const double r : {0.1, 0.7, 1.3, 2.2}) {
            double growth = 0.0;
            ASSERT_TRUE(PinholeGrowth::at(lens.data(), r, &growth));
            EXPECT_NEAR(growth,
                        (radial(lens, r + kStep) - radial(lens, r - kStep)) / (2.0 * kStep),
                        kDifferences);
        }
    }
}

TEST(GrowingImage, GrowthOfAFisheyeIsTheSlopeOfItsProfile) {
    constexpr double kStep = 1e-5;
    constexpr double kDifferences = 1e-8;
    for (const Fisheye& lens : {kNearlyHalf, kTurningFisheye}) {
        for (const double theta : {0.1, 0.7, 1.3, 2.2}) {
            double growth = 0.0;
            ASSERT_TRUE(FisheyeGrowth::at(lens.data(), theta, &growth));
            EXPECT_NEAR(
                growth,
                (angular(lens, theta + kStep) - angular(lens, theta - kStep)) / (2.0 * kStep),
                kDifferences);
        }
    }
}

TEST(GrowingImage, AFisheyeThatTurnsBackIsNoticed) {
    EXPECT_FALSE(check_growth<FisheyeGrowth>(kNearlyHalf.data(), kSize).turns_back);
    EXPECT_TRUE(check_growth<FisheyeGrowth>(kTurningFisheye.data(), kSize).turns_back);
    // A smaller image ends before the fold.
    Fisheye cropped = kTurningFisheye;
    cropped[2] = 80.0;
    cropped[3] = 60.0;
    EXPECT_FALSE(check_growth<FisheyeGrowth>(cropped.data(), {161, 121}).turns_back);
}

TEST(GrowingImage, WhatLacksIsZeroForALensThatGrows) {
    std::array<double, kGrowthPlaces> lack{};
    const int places = check_growth<FisheyeGrowth>(kNearlyHalf.data(), kSize).places;
    const GrowthLack<FisheyeGrowth> of_places{places, 5.0};
    ASSERT_TRUE(of_places(kNearlyHalf.data(), lack.data()));
    EXPECT_EQ(*std::max_element(lack.begin(), lack.end()), 0.0);
    ASSERT_TRUE(of_places(kTurningFisheye.data(), lack.data()));
    // Beyond the fold, at 1.475 rad, more than the whole least growth is missing.
    const double theta = growth_place(29);
    double growth = 0.0;
    (void)FisheyeGrowth::at(kTurningFisheye.data(), theta, &growth);
    EXPECT_NEAR(lack[29], 5.0 * (0.5 * std::cos(0.5 * theta) - growth), 1e-12);
    EXPECT_GT(lack[29], 0.5);
}

TEST(GrowingImage, ALensThatReachesItsCornersDoesNotTurnBack) {
    const GrowthCheck check = check_growth<PinholeGrowth>(kWide.data(), kSize);
    EXPECT_FALSE(check.turns_back);
    EXPECT_NEAR(growth_place(check.places - 1), 1.422, kGrowthStep);
}

TEST(GrowingImage, OneThatTurnsBackBeforeIsNoticed) {
    EXPECT_TRUE(check_growth<PinholeGrowth>(kTurning.data(), kSize).turns_back);
    // A smaller image ends before the fold.
    Lens cropped = kTurning;
    cropped[2] = 100.0;
    cropped[3] = 75.0;
    EXPECT_FALSE(check_growth<PinholeGrowth>(cropped.data(), {201, 151}).turns_back);
}

TEST(GrowingImage, APoleLiesBeyondEveryCorner) {
    Lens pole = kWide;
    pole[4] = pole[5] = pole[8] = pole[9] = pole[10] = 0.0;
    pole[11] = -8.0;  // a pole at r = 0.71, where the image is at infinity
    EXPECT_FALSE(check_growth<PinholeGrowth>(pole.data(), kSize).turns_back);
    double growth = 0.0;
    EXPECT_FALSE(PinholeGrowth::at(pole.data(), 0.8, &growth));
}

}  // namespace
}  // namespace surefoot::calibration
