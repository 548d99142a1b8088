// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/confidence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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

TEST(OutlierProbability, IsSmallForAGoodMatchAndHighNextToAJump) {
    EXPECT_LT(outlier_probability(kGood), 0.01F);
    EXPECT_GE(outlier_probability(changed([](auto& e) { e.jump_distance_px = kJumpZone_px; })),
              kJumpOutlierProbability);
    EXPECT_LT(outlier_probability(changed([](auto& e) { e.jump_distance_px = kJumpZone_px + 1; })),
              kJumpOutlierProbability);
}

TEST(OutlierProbability, GrowsWithEveryWarning) {
    const float good = outlier_probability(kGood);
    EXPECT_GT(outlier_probability(changed([](auto& e) { e.jump_distance_px = 6; })), good);
    EXPECT_GT(outlier_probability(changed([](auto& e) { e.gradient_grey_px = 0.0F; })), good);
    EXPECT_GT(outlier_probability(changed([](auto& e) { e.shift_px = 0.9F; })), good);
    EXPECT_GT(outlier_probability(changed([](auto& e) { e.unknown_share = 0.5F; })), good);
}

TEST(RateMatches, UnknownHasNoSigmaAndIsNoInlier) {
    Serial serial;
    camera::DepthImage depth;
    depth.resize(2, 1);
    depth.disparity_px.at(0, 0) = 12.0F;
    depth.disparity_px.at(1, 0) = std::numeric_limits<float>::quiet_NaN();
    Refinement refinement;
    for (auto* image :
         {&refinement.residual_grey, &refinement.gradient_grey_px, &refinement.shift_px}) {
        *image = Image<float>(2, 1, 0.5F);
    }
    const Image<std::uint8_t> jump_distance_px(2, 1, 200);
    const Image<float> share(2, 1, 0.0F);
    rate_matches(serial, refinement, jump_distance_px, share, depth);
    EXPECT_GT(depth.sigma_px.at(0, 0), 0.0F);
    EXPECT_LT(depth.outlier_probability.at(0, 0), 0.1F);
    EXPECT_TRUE(std::isnan(depth.sigma_px.at(1, 0)));
    EXPECT_EQ(depth.outlier_probability.at(1, 0), 1.0F);
}

}  // namespace
}  // namespace surefoot::stereo
