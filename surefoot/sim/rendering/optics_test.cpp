// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/optics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::sim {
namespace {

Image<float> noise_image(int width, int height) {
    Image<float> image(width, height);
    Rng rng(5);
    for (std::size_t i = 0; i < image.size(); ++i) {
        image.data()[i] = static_cast<float>(rng.uniform(0.0, 200.0));
    }
    return image;
}

TEST(OpticsTest, TheSpotSumsToOneAndHasItsSigma) {
    for (const double sigma_px : {0.2, 0.5, 0.8, 2.0, 7.5}) {
        const auto kernel = smear_kernel(sigma_px);
        ASSERT_EQ(kernel.size() % 2, 1U);
        const int radius = static_cast<int>(kernel.size() / 2);
        double sum = 0.0;
        double mean = 0.0;
        double square = 0.0;
        for (int i = -radius; i <= radius; ++i) {
            const auto weight = static_cast<double>(kernel[static_cast<std::size_t>(i + radius)]);
            sum += weight;
            mean += weight * i;
            square += weight * i * i;
        }
        EXPECT_NEAR(sum, 1.0, 1e-6) << sigma_px;
        EXPECT_NEAR(mean, 0.0, 1e-6) << sigma_px;
        EXPECT_NEAR(std::sqrt(square), sigma_px, 1e-4 * sigma_px);
    }
    EXPECT_EQ(smear_kernel(0.0), std::vector<float>{1.0F});
}

TEST(OpticsTest, SmearingIsAConvolutionWithTheSpot) {
    const auto kernel = smear_kernel(1.3);
    const int radius = static_cast<int>(kernel.size() / 2);
    const Image<float> before = noise_image(37, 23);
    Image<float> after = before;
    Serial serial;
    smear(kernel, serial, after);
    for (int v = 0; v < 23; ++v) {
        for (int u = 0; u < 37; ++u) {
            double sum = 0.0;
            for (int dv = -radius; dv <= radius; ++dv) {
                for (int du = -radius; du <= radius; ++du) {
                    const auto weight =
                        static_cast<double>(kernel[static_cast<std::size_t>(du + radius)] *
                                            kernel[static_cast<std::size_t>(dv + radius)]);
                    sum += weight * static_cast<double>(before.at(std::clamp(u + du, 0, 36),
                                                                  std::clamp(v + dv, 0, 22)));
                }
            }
            EXPECT_NEAR(static_cast<double>(after.at(u, v)), sum, 1e-3) << u << " " << v;
        }
    }
    Image<float> backwards = before;
    Backwards executor;
    smear(kernel, executor, backwards);
    EXPECT_EQ(after, backwards);
}

TEST(OpticsTest, AFingerMarkBlursItsPlaceOnOneEyeOnly) {
    OpticsConfig config;
    config.smudge_sigma_px = 4.0;
    config.smudge_x = 0.25;
    config.smudge_y = 0.5;
    config.smudge_radius = 0.2;  // share of 60 rows: 12 px round (20, 30)
    const Image<float> before = noise_image(80, 60);
    Image<float> greasy = before;
    Serial serial;
    smear(smear_kernel(4.0), serial, greasy);
    Image<float> left = before;
    apply_optics(config, true, serial, left);
    EXPECT_EQ(left.at(20, 30), greasy.at(20, 30));
    EXPECT_EQ(left.at(26, 30), greasy.at(26, 30));  // 6.5 px from the middle, sharp from 12
    EXPECT_EQ(left.at(32, 30), before.at(32, 30));
    EXPECT_EQ(left.at(20, 43), before.at(20, 43));
    EXPECT_NE(left.at(29, 30), greasy.at(29, 30));
    EXPECT_NE(left.at(29, 30), before.at(29, 30));
    Image<float> right = before;
    apply_optics(config, false, serial, right);
    EXPECT_EQ(right, before);
    config.smudge_camera = EyePoint::both;
    apply_optics(config, false, serial, right);
    EXPECT_EQ(right, left);
}

}  // namespace
}  // namespace surefoot::sim
