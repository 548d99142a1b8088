// SPDX-License-Identifier: Apache-2.0
#include "surefoot/place_recognition/describe.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "surefoot/core/rng.hpp"
#include "surefoot/place_recognition/feature_matching.hpp"

namespace surefoot::place_recognition {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;
/// Corners of the coarsest level lie on a lattice of 1.2^5 px, along both axes.
constexpr float kQuantum_px = 2.49F * 1.42F;

/// Blocks of random grey, moved right by `shift_px`.
GreyImage blocks(int shift_px) {
    GreyImage image(kWidth, kHeight);
    for (int v = 0; v < kHeight; ++v)
        for (int u = 0; u < kWidth; ++u) {
            const auto block =
                static_cast<std::uint64_t>((v / 9) * 1000 + (u + 64 - shift_px) / 11);
            image.at(u, v) = static_cast<std::uint8_t>(40 + mix_seed(3, block) % 170);
        }
    return image;
}

DepthImage even_depth(float disparity_px, float outlier_probability = 0.0F) {
    DepthImage depth;
    depth.resize(kWidth, kHeight);
    depth.disparity_px.fill(disparity_px);
    depth.sigma_px.fill(0.2F);
    depth.outlier_probability.fill(outlier_probability);
    return depth;
}

TEST(Describe, FindsTheSameCornersWhereTheyHaveGone) {
    const auto here = describe({}, blocks(0).view(), even_depth(10.0F));
    const auto there = describe({}, blocks(23).view(), even_depth(10.0F));
    ASSERT_GT(here.size(), 100U);
    EXPECT_LE(here.size(), static_cast<std::size_t>(kMostFeatures));
    const auto matches = match_features({}, here, there);
    ASSERT_GT(matches.size(), here.size() / 2);
    std::size_t right = 0;
    for (const FeatureMatch& match : matches) {
        const Eigen::Vector3f moved = there[static_cast<std::size_t>(match.query)].pixel_px -
                                      here[static_cast<std::size_t>(match.candidate)].pixel_px;
        if ((moved - Eigen::Vector3f(23.0F, 0.0F, 23.0F)).norm() < kQuantum_px) ++right;
    }
    EXPECT_GT(right, matches.size() * 95 / 100);
}

TEST(Describe, CornersHaveTheDisparityOfTheirPixelOrAreLeftOut) {
    for (const Feature& feature : describe({}, blocks(0).view(), even_depth(10.0F)))
        EXPECT_FLOAT_EQ(feature.pixel_px.x() - feature.pixel_px.z(), 10.0F);
    EXPECT_TRUE(describe({}, blocks(0).view(), even_depth(std::nanf(""))).empty());
    EXPECT_TRUE(describe({}, blocks(0).view(), even_depth(1.0F)).empty()) << "too far";
    EXPECT_TRUE(describe({}, blocks(0).view(), even_depth(10.0F, 0.9F)).empty()) << "not trusted";
    DepthImage left_half = even_depth(10.0F);
    for (int v = 0; v < kHeight; ++v)
        for (int u = kWidth / 2; u < kWidth; ++u) left_half.disparity_px.at(u, v) = std::nanf("");
    const auto features = describe({}, blocks(0).view(), left_half);
    EXPECT_GT(features.size(), 50U);
    for (const Feature& feature : features) EXPECT_LT(feature.pixel_px.x(), kWidth / 2);
}

TEST(Describe, SpreadsFeaturesOverTheImage) {
    std::vector<int> quarter(4);
    for (const Feature& feature : describe({}, blocks(0).view(), even_depth(10.0F)))
        ++quarter[(feature.pixel_px.x() < kWidth / 2 ? 0U : 1U) +
                  (feature.pixel_px.y() < kHeight / 2 ? 0U : 2U)];
    for (const int count : quarter) EXPECT_GT(count, 25);
}

/// Three fifths of the image are a floor with many corners, the rest is a wall with low contrast.
TEST(Describe, ARichFloorLeavesRoomForAFaintWall) {
    constexpr int kEdge = kHeight * 2 / 5;
    GreyImage image = blocks(0);
    for (int v = 0; v < kEdge; ++v)
        for (int u = 0; u < kWidth; ++u)
            image.at(u, v) = static_cast<std::uint8_t>(100 + image.at(u, v) / 5);
    const auto features = describe({}, image.view(), even_depth(10.0F));
    const auto on_wall = std::count_if(
        features.begin(), features.end(), [](const Feature& f) { return f.pixel_px.y() < kEdge; });
    // Two fifths of the image must have at least a quarter of the features.
    EXPECT_GT(4 * static_cast<std::size_t>(on_wall), features.size());
    EXPECT_GT(features.size() - static_cast<std::size_t>(on_wall), 150U);
}

TEST(Describe, AnImageWithoutStructureHasNoFeatures) {
    EXPECT_TRUE(describe({}, GreyImage(kWidth, kHeight, 90).view(), even_depth(10.0F)).empty());
    DepthImage small;
    small.resize(40, 40);
    EXPECT_TRUE(describe({}, GreyImage(40, 40, 90).view(), small).empty());
}

}  // namespace
}  // namespace surefoot::place_recognition
