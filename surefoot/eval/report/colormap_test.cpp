// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/report/colormap.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace surefoot::eval {
namespace {

TEST(ColorMap, SequentialMapsGrowInLightness) {
    for (const ColorMap map :
         {ColorMap::viridis, ColorMap::cividis, ColorMap::magma, ColorMap::grey}) {
        for (int k = 1; k <= 128; ++k) {
            EXPECT_GT(lightness(color_at(map, k / 128.0)),
                      lightness(color_at(map, (k - 1) / 128.0)))
                << "map " << int(map) << " at " << k;
        }
    }
}

TEST(ColorMap, PaleGroundGrowsInLightnessAndIsLighterThanTheLinesOverIt) {
    const auto lightness_at = [](int k) { return lightness(color_at(ColorMap::pale, k / 32.0)); };
    EXPECT_GT(lightness_at(0), lightness(palette::kUnsafe));
    EXPECT_GT(lightness_at(0), lightness(palette::kSafe));
    // In 32 steps: its finer ones are as small as the rounding of the channels.
    for (int k = 1; k <= 32; ++k) EXPECT_GT(lightness_at(k), lightness_at(k - 1)) << k;
}

TEST(ColorMap, DivergingMapsAreLightestInTheMiddle) {
    for (const ColorMap map : {ColorMap::safety, ColorMap::balance}) {
        EXPECT_TRUE(is_diverging(map));
        for (int k = 1; k < 64; ++k) {
            EXPECT_GT(lightness(color_at(map, k / 128.0)),
                      lightness(color_at(map, (k - 1) / 128.0)));
            EXPECT_GT(lightness(color_at(map, 1.0 - k / 128.0)),
                      lightness(color_at(map, 1.0 - (k - 1) / 128.0)));
        }
    }
}

/// 17 anchors against the published tables of 256 entries; cividis has a kink between two of them.
TEST(ColorMap, PublishedMapsAreReproduced) {
    constexpr int kLargestDifference = 11;
    for (const auto& [ours, theirs] : {std::pair{ColorMap::viridis, cv::COLORMAP_VIRIDIS},
                                       std::pair{ColorMap::cividis, cv::COLORMAP_CIVIDIS},
                                       std::pair{ColorMap::magma, cv::COLORMAP_MAGMA}}) {
        cv::Mat grey(1, 256, CV_8U), table;
        for (int k = 0; k < 256; ++k) grey.at<std::uint8_t>(0, k) = static_cast<std::uint8_t>(k);
        cv::applyColorMap(grey, table, theirs);
        for (int k = 0; k < 256; ++k) {
            const auto bgr = table.at<cv::Vec3b>(0, k);
            const Rgb8 rgb = color_at(ours, k / 255.0);
            const int off = std::max(
                {std::abs(rgb.r - bgr[2]), std::abs(rgb.g - bgr[1]), std::abs(rgb.b - bgr[0])});
            EXPECT_LE(off, kLargestDifference) << "map " << int(ours) << " entry " << k;
        }
    }
}

TEST(ColorMap, SafetyJumpsAtTheThreshold) {
    const ColorScale scale{ColorMap::safety, 0.0, 1.0, 0.8};
    const Rgb8 below = scale(std::nextafter(0.8, 0.0));
    const Rgb8 at = scale(0.8);
    EXPECT_GT(below.r, below.b);  // orange
    EXPECT_LT(at.r, at.b);        // blue
    EXPECT_EQ(scale(-3.0), scale(0.0));
    EXPECT_EQ(scale(7.0), scale(1.0));
}

TEST(ColorMap, CentreOfTheScaleIsTheMiddleColour) {
    const ColorScale scale{ColorMap::balance, -1.0, 3.0, 0.0};
    EXPECT_EQ(scale(0.0), color_at(ColorMap::balance, 0.5));
    EXPECT_EQ(scale(-0.5), color_at(ColorMap::balance, 0.25));
    EXPECT_EQ(scale(1.5), color_at(ColorMap::balance, 0.75));
}

TEST(ColorMap, AScaleWithoutWidthStillHasAColour) {
    EXPECT_EQ((ColorScale{ColorMap::viridis, 2.0, 2.0, 2.0})(2.0),
              color_at(ColorMap::viridis, 0.5));
}

TEST(ColorMap, LightnessOfBlackGreyAndWhite) {
    EXPECT_NEAR(lightness({0, 0, 0}), 0.0, 1e-12);
    EXPECT_NEAR(lightness({255, 255, 255}), 100.0, 1e-9);
    EXPECT_NEAR(lightness({119, 119, 119}), 50.0, 0.1);  // the usual middle grey
}

}  // namespace
}  // namespace surefoot::eval
