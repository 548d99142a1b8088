// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/imaging.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace surefoot::sim {
namespace {

TEST(ImagingTest, PixelNoiseIsWhiteAndNormal) {
    const PixelNoise noise;
    constexpr std::uint32_t kCount = 400'000;
    double sum = 0.0;
    double squares = 0.0;
    double fourths = 0.0;
    double neighbours = 0.0;
    int beyond_two = 0;
    double previous = 0.0;
    for (std::uint32_t i = 0; i < kCount; ++i) {
        const double x = static_cast<double>(noise.normal(PixelNoise::key(5, 9), i));
        sum += x;
        squares += x * x;
        fourths += x * x * x * x;
        neighbours += x * previous;
        beyond_two += std::abs(x) > 2.0 ? 1 : 0;
        previous = x;
    }
    // Five standard errors of each estimate over this many samples.
    const double five_sigma = 5.0 / std::sqrt(static_cast<double>(kCount));
    EXPECT_NEAR(sum / kCount, 0.0, five_sigma);
    EXPECT_NEAR(squares / kCount, 1.0, five_sigma * std::sqrt(2.0));
    EXPECT_NEAR(fourths / kCount, 3.0, five_sigma * std::sqrt(96.0) + 0.01);
    EXPECT_NEAR(neighbours / kCount, 0.0, five_sigma);
    EXPECT_NEAR(beyond_two / static_cast<double>(kCount), 0.0455, five_sigma * 0.21);
}

TEST(ImagingTest, StreamsAreIndependentAndRepeatable) {
    const PixelNoise noise;
    double product = 0.0;
    constexpr std::uint32_t kCount = 100'000;
    for (std::uint32_t i = 0; i < kCount; ++i) {
        EXPECT_EQ(noise.normal(PixelNoise::key(1, 2), i), noise.normal(PixelNoise::key(1, 2), i));
        product += static_cast<double>(noise.normal(PixelNoise::key(1, 2), i) *
                                       noise.normal(PixelNoise::key(1, 3), i));
    }
    EXPECT_NEAR(product / kCount, 0.0, 5.0 / std::sqrt(static_cast<double>(kCount)));
}

TEST(ImagingTest, GreyValuesHaveTheConfiguredVariance) {
    const PixelNoise noise;
    ImagingConfig config;
    config.read_noise_dn = 1.5;
    config.shot_noise_dn = 0.03;
    for (const float signal_dn : {40.3F, 128.0F, 200.7F}) {
        constexpr std::uint32_t kCount = 200'000;
        double sum = 0.0;
        double squares = 0.0;
        for (std::uint32_t i = 0; i < kCount; ++i) {
            const double value =
                exposed_pixel(config, 1.0, signal_dn, noise.normal(PixelNoise::key(1, 1), i));
            sum += value;
            squares += value * value;
        }
        const double mean = sum / kCount;
        const double variance = squares / kCount - mean * mean;
        constexpr double kRounding = 1.0 / 12.0;
        const double expected = 1.5 * 1.5 + 0.03 * static_cast<double>(signal_dn) + kRounding;
        EXPECT_NEAR(mean, static_cast<double>(signal_dn), 0.03);
        EXPECT_NEAR(variance, expected, 5.0 * expected * std::sqrt(2.0 / kCount));
    }
}

TEST(ImagingTest, ARowIsExposedLikeItsPixels) {
    const PixelNoise noise;
    const std::uint64_t key = PixelNoise::key(3, 4);
    const ImagingConfig config;
    constexpr std::uint32_t kFirst = 10'001;  // not a multiple of four
    std::vector<float> signal(203);
    for (std::size_t i = 0; i < signal.size(); ++i) signal[i] = 1.5F * static_cast<float>(i);
    std::vector<float> normals(signal.size());
    noise.fill(key, kFirst, normals);
    for (const double gain : {1.0, 3.0}) {
        std::vector<std::uint8_t> row(signal.size());
        expose_row(config, gain, 0.75, signal, normals, row);
        for (std::size_t i = 0; i < signal.size(); ++i) {
            const float normal = noise.normal(key, kFirst + static_cast<std::uint32_t>(i));
            ASSERT_EQ(normals[i], normal) << i;
            EXPECT_EQ(row[i], exposed_pixel(config, gain, 0.75F * signal[i], normal)) << i;
        }
    }
}

TEST(ImagingTest, GainAmplifiesTheNoise) {
    ImagingConfig config;
    config.read_noise_dn = 1.5;
    config.shot_noise_dn = 0.5;
    // One sigma at signal 32: sqrt(3^2 + 2 * 0.5 * 32) = 6.4 with gain 2.
    EXPECT_EQ(exposed_pixel(config, 2.0, 32.0F, 1.0F), 38);
    EXPECT_EQ(exposed_pixel(config, 1.0, 32.0F, 1.0F), 36);
}

TEST(ImagingTest, ValuesSaturateAtBothEnds) {
    const ImagingConfig config;
    EXPECT_EQ(exposed_pixel(config, 1.0, 400.0F, 0.0F), 255);
    EXPECT_EQ(exposed_pixel(config, 1.0, 0.0F, -3.0F), 0);
    EXPECT_EQ(exposed_pixel(config, 1.0, 17.4F, 0.0F), 17);
}

}  // namespace
}  // namespace surefoot::sim
