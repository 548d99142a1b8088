// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/smooth_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace surefoot::sim {
namespace {

constexpr int kWidth = 240;
constexpr int kHeight = 160;

std::vector<float> image(const PixelNoise& noise,
                         std::uint64_t seed,
                         int stride,
                         double length_px) {
    const SmoothNoise smooth(noise, seed, kWidth / stride, kHeight / stride, stride, length_px);
    std::vector<float> scratch;
    std::vector<float> result;
    std::vector<float> row(static_cast<std::size_t>(kWidth / stride));
    for (int v = 0; v < kHeight / stride; ++v) {
        smooth.row(v, scratch, row);
        result.insert(result.end(), row.begin(), row.end());
    }
    return result;
}

/// Mean over many images of the product of values `lag_px` apart.
double correlation(const PixelNoise& noise, double length_px, int lag_px, bool down) {
    constexpr int kImages = 250;
    double sum = 0.0;
    int count = 0;
    for (std::uint64_t seed = 0; seed < kImages; ++seed) {
        const std::vector<float> values = image(noise, seed, 1, length_px);
        for (int v = 0; v + (down ? lag_px : 0) < kHeight; v += 8) {
            for (int u = 0; u + (down ? 0 : lag_px) < kWidth; u += 8) {
                const auto here = static_cast<std::size_t>(v * kWidth + u);
                const auto there = here + static_cast<std::size_t>(down ? lag_px * kWidth : lag_px);
                sum += static_cast<double>(values[here]) * static_cast<double>(values[there]);
                ++count;
            }
        }
    }
    return sum / count;
}

TEST(SmoothNoiseTest, VarianceIsOneAndCorrelationFallsToOneOverEAtItsLength) {
    const PixelNoise noise;
    // About 250 * 240 * 160 / (2 * 18^2) = 15 000 independent places: five standard errors of a
    // product are at most 0.06.
    EXPECT_NEAR(correlation(noise, 18.0, 0, false), 1.0, 0.06);
    for (const bool down : {false, true}) {
        EXPECT_NEAR(correlation(noise, 18.0, 18, down), 1.0 / std::numbers::e, 0.04);
        EXPECT_GT(correlation(noise, 18.0, 9, down), 0.65);
        EXPECT_NEAR(correlation(noise, 18.0, 70, down), 0.0, 0.04);
    }
}

TEST(SmoothNoiseTest, StrideTakesEveryNthValueOfTheSameNoise) {
    const PixelNoise noise;
    const std::vector<float> full = image(noise, 3, 1, 20.0);
    const std::vector<float> thin = image(noise, 3, 4, 20.0);
    ASSERT_EQ(thin.size(), full.size() / 16);
    for (int v = 0; v < kHeight / 4; ++v) {
        for (int u = 0; u < kWidth / 4; ++u) {
            const auto there = static_cast<std::size_t>(4 * v * kWidth + 4 * u);
            const auto here = static_cast<std::size_t>(v * (kWidth / 4) + u);
            // Their places on the lattice are rounded differently.
            EXPECT_NEAR(thin[here], full[there], 1e-5F) << u << " " << v;
        }
    }
}

TEST(SmoothNoiseTest, SurfaceNoiseHasVarianceOneEverywhereAndIsContinuous) {
    const PixelNoise noise;
    for (const double place_m : {0.0, 0.025, 0.05}) {
        double squares = 0.0;
        constexpr int kSeeds = 8000;
        for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
            const SurfaceNoise surface(seed, 0.1);
            const auto value =
                static_cast<double>(surface.at(noise, 2, -3.0 + place_m, 1.0 - place_m));
            squares += value * value / kSeeds;
        }
        EXPECT_NEAR(squares, 1.0, 5.0 * std::sqrt(2.0 / kSeeds)) << place_m;
    }
    const SurfaceNoise surface(4, 0.1);
    for (double u_m = -1.0; u_m < 1.0; u_m += 0.001) {
        const float step =
            surface.at(noise, 0, u_m + 1e-6, 0.333) - surface.at(noise, 0, u_m, 0.333);
        EXPECT_LT(std::abs(step), 1e-3F) << u_m;
    }
    EXPECT_NE(surface.at(noise, 0, 0.5, 0.5), surface.at(noise, 1, 0.5, 0.5));
}

/// Visits positions on several surfaces and across borders of squares, back and forth.
TEST(SmoothNoiseTest, ARememberedSquareChangesNoSurfaceNoise) {
    const PixelNoise noise;
    const SurfaceNoise surface(4, 0.1);
    SurfaceNoise::Square square;
    for (int i = 0; i < 4000; ++i) {
        const int face = i / 7 % 3;
        const double u_m = 0.013 * (i % 50) - 0.3;
        const double v_m = 0.004 * (i % 90) - 0.2;
        ASSERT_EQ(surface.at(noise, face, u_m, v_m, square), surface.at(noise, face, u_m, v_m))
            << i;
    }
}

}  // namespace
}  // namespace surefoot::sim
