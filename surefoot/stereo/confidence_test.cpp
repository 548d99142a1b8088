// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/confidence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/stereo/finisher.hpp"
#include "surefoot/stereo/stereo_targets_testing.hpp"

namespace surefoot::stereo {
namespace {

constexpr MatchEvidence kGood{.residual_grey = 1.0F, .gradient_grey_px = 4.0F};

template <typename Change>
MatchEvidence changed(Change change) {
    MatchEvidence evidence = kGood;
    change(evidence);
    return evidence;
}

TEST(MatchSigma, NeverBelowTheFloorNorAboveTheCap) {
    EXPECT_GE(match_sigma_px(kGood), kSigmaFloor_px);
    EXPECT_LT(match_sigma_px(kGood), 1.2F * kSigmaFloor_px);
    const float no_texture = match_sigma_px(changed([](auto& e) { e.gradient_grey_px = 0.0F; }));
    EXPECT_EQ(no_texture, kMaxSigma_px);
}

TEST(MatchSigma, GrowsWithNoiseAndWithLessTexture) {
    EXPECT_GT(match_sigma_px(changed([](auto& e) { e.residual_grey = 8.0F; })),
              match_sigma_px(kGood));
    EXPECT_GT(match_sigma_px(changed([](auto& e) { e.gradient_grey_px = 0.5F; })),
              match_sigma_px(kGood));
    EXPECT_GT(match_sigma_px(changed([](auto& e) { e.shift_px = -0.3F; })), match_sigma_px(kGood));
}

TEST(OutlierProbability, IsSmallForAGoodMatchAndHighOnTheNearSideOfAJump) {
    EXPECT_LT(outlier_probability(kGood), 0.01F);
    EXPECT_GE(
        outlier_probability(changed([](auto& e) { e.nearer_by_px = kNearSideStep_px + 0.1F; })),
        kNearSideOutlierProbability);
    EXPECT_LT(outlier_probability(changed([](auto& e) { e.nearer_by_px = kNearSideStep_px; })),
              0.01F);
    EXPECT_LT(outlier_probability(changed([](auto& e) { e.jump_distance_px = 0; })), 0.1F)
        << "the far side";
}

/// An image in which a share of the rows is matched.
DepthImage matched_rows(int width, int height, int of_ten) {
    DepthImage depth;
    depth.resize(width, height);
    depth.sigma_px.fill(kMaxSigma_px);
    depth.outlier_probability.fill(0.01F);
    for (int v = 0; v < height; ++v)
        std::fill_n(depth.disparity_px.row(v),
                    width,
                    v % 10 < of_ten ? 12.0F : std::numeric_limits<float>::quiet_NaN());
    return depth;
}

TEST(IsolatedMatches, AreDoubtedIfMostPixelsAroundHaveNoMatch) {
    IsolatedMatches isolated;
    for (const int side : {100, 37, 8}) {
        for (int of_ten = 1; of_ten <= 10; ++of_ten) {
            DepthImage depth = matched_rows(side + 3, side, of_ten);
            depth.sigma_px.at(1, 0) = 0.5F * kMaxSigma_px;  // with texture
            isolated.doubt(depth);
            EXPECT_EQ(depth.outlier_probability.at(1, 0), 0.01F);
            if (of_ten > 3 && of_ten < 7) continue;  // blocks hold no whole number of ten rows
            EXPECT_EQ(depth.outlier_probability.at(side - 1, side / 20 * 10),
                      of_ten <= 3 ? kIsolatedOutlierProbability : 0.01F)
                << side << " " << of_ten;
        }
    }
    EXPECT_GT(kIsolatedOutlierProbability, kTrustedOutlierProbability);
}

/// Matches at a distance of 3 x 3 blocks do not count.
TEST(IsolatedMatches, AreJudgedByTheirNeighbourhood) {
    DepthImage depth = matched_rows(400, 100, 10);
    for (int v = 0; v < 100; ++v)
        for (int u = 160; u < 400; ++u)
            if (u < 300 || u >= 310)
                depth.disparity_px.at(u, v) = std::numeric_limits<float>::quiet_NaN();
    IsolatedMatches().doubt(depth);
    EXPECT_EQ(depth.outlier_probability.at(40, 50), 0.01F);
    EXPECT_EQ(depth.outlier_probability.at(305, 50), kIsolatedOutlierProbability);
}

/// The finisher passes the smallest disparity nearby: both sides of the step have the same texture.
TEST(OutlierProbability, TheFinisherKnowsTheNearSide) {
    constexpr int kWidth = 120;
    constexpr int kHeight = 60;
    constexpr float kFar_px = 4.0F;
    constexpr float kNear_px = 10.0F;
    Rng rng(8);
    GreyImage image(kWidth, kHeight);
    for (std::size_t i = 0; i < image.size(); ++i)
        image.data()[i] = static_cast<std::uint8_t>(rng.uniform(0.0, 255.0));
    Image<float> found_px(kWidth, kHeight, kFar_px);
    for (int v = 0; v < kHeight; ++v)
        for (int u = 70; u < kWidth; ++u) found_px.at(u, v) = kNear_px;
    Serial serial;
    DepthImage depth;
    depth.resize(kWidth, kHeight);
    Finisher().finish(image.view(), image.view(), found_px, Filter::none, serial, depth);
    int near_side = 0;
    for (int v = 10; v < kHeight - 10; ++v) {
        for (int u = 70; u < 72; ++u) {
            ++near_side;
            EXPECT_GE(depth.outlier_probability.at(u, v), kNearSideOutlierProbability) << u;
        }
    }
    EXPECT_EQ(near_side, 2 * (kHeight - 20));
}

TEST(OutlierProbability, GrowsWithEveryWarning) {
    const float good = outlier_probability(kGood);
    EXPECT_GT(outlier_probability(changed([](auto& e) { e.jump_distance_px = 6; })), good);
    EXPECT_GT(outlier_probability(changed([](auto& e) { e.gradient_grey_px = 0.0F; })), good);
    EXPECT_GT(outlier_probability(changed([](auto& e) { e.shift_px = 0.9F; })), good);
    EXPECT_GT(outlier_probability(changed([](auto& e) { e.unknown_share = 0.5F; })), good);
}

/// On every processor, rows give the same values as the definition for single pixels.
TEST(RateMatches, IsTheDefinitionOnEveryProcessor) {
    constexpr int kWidth = 500;
    constexpr int kHeight = 2;
    constexpr int kRadius = 4;
    Rng rng(4);
    DepthImage depth;
    depth.resize(kWidth, kHeight);
    depth.disparity_px.fill(12.0F);
    std::vector<float> residual(kWidth);
    std::vector<float> gradient(kWidth);
    std::vector<float> shift(kWidth);
    Image<std::uint8_t> jump_distance_px(kWidth, kHeight);
    UnknownCounts unknown{Image<std::uint8_t>(kWidth, kHeight), kRadius};
    Image<float> smallest_px(kWidth, kHeight);
    for (int u = 0; u < kWidth; ++u) {
        const auto i = static_cast<std::size_t>(u);
        residual[i] = static_cast<float>(std::exp(rng.uniform(-3.0, 4.0)));
        gradient[i] = u % 9 == 0 ? 0.0F : static_cast<float>(std::exp(rng.uniform(-6.0, 4.0)));
        shift[i] = static_cast<float>(rng.uniform(-1.0, 1.0));
        jump_distance_px.at(u, 1) = static_cast<std::uint8_t>(u % 7 == 0 ? 255 : u % 16);
        unknown.pixels.at(u, 1) = static_cast<std::uint8_t>(rng.below(11));
        smallest_px.at(u, 1) = 12.0F - static_cast<float>(u % 5);
    }
    std::vector<float> first;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        rate_matches(1,
                     {residual.data(), gradient.data(), shift.data()},
                     jump_distance_px,
                     unknown,
                     smallest_px,
                     depth);
        std::vector<float> all(depth.sigma_px.row(1), depth.sigma_px.row(1) + kWidth);
        all.insert(
            all.end(), depth.outlier_probability.row(1), depth.outlier_probability.row(1) + kWidth);
        if (first.empty()) first = all;
        EXPECT_EQ(all, first) << hwy::TargetName(target);
        for (int u = 0; u < kWidth; ++u) {
            const auto i = static_cast<std::size_t>(u);
            const int area = kHeight * window_span(u, kRadius, kWidth);
            const MatchEvidence evidence{
                residual[i],
                gradient[i],
                shift[i],
                jump_distance_px.at(u, 1),
                static_cast<float>(unknown.pixels.at(u, 1)) / static_cast<float>(area),
                static_cast<float>(u % 5)};
            ASSERT_NEAR(depth.sigma_px.at(u, 1), match_sigma_px(evidence), 1e-6F) << u;
            ASSERT_NEAR(depth.outlier_probability.at(u, 1), outlier_probability(evidence), 2e-6F)
                << u;
        }
    }
    hwy::SetSupportedTargetsForTest(0);
}

TEST(RateMatches, UnknownHasNoSigmaAndIsNoInlier) {
    DepthImage depth;
    depth.resize(2, 1);
    depth.disparity_px.at(0, 0) = 12.0F;
    depth.disparity_px.at(1, 0) = std::numeric_limits<float>::quiet_NaN();
    const float halves[2] = {0.5F, 0.5F};
    const Image<std::uint8_t> jump_distance_px(2, 1, 200);
    const UnknownCounts unknown{Image<std::uint8_t>(2, 1, 0), 4};
    const Image<float> smallest_px(2, 1, 12.0F);
    rate_matches(0, {halves, halves, halves}, jump_distance_px, unknown, smallest_px, depth);
    EXPECT_GT(depth.sigma_px.at(0, 0), 0.0F);
    EXPECT_LT(depth.outlier_probability.at(0, 0), 0.1F);
    EXPECT_TRUE(std::isnan(depth.sigma_px.at(1, 0)));
    EXPECT_EQ(depth.outlier_probability.at(1, 0), 1.0F);
}

}  // namespace
}  // namespace surefoot::stereo
