// SPDX-License-Identifier: Apache-2.0
#include "surefoot/place_recognition/feature_matching.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "surefoot/place_recognition/place_views_testing.hpp"

namespace surefoot::place_recognition {
namespace {

std::vector<Feature> random_features(int count, std::uint64_t seed) {
    Rng rng(seed);
    std::vector<Feature> features;
    for (int i = 0; i < count; ++i) {
        const Eigen::Vector3d px(rng.uniform(0.0, 600.0), rng.uniform(0.0, 300.0), 0.0);
        features.push_back({px.cast<float>(), testing::random_descriptor(rng)});
    }
    return features;
}

TEST(FeatureMatching, FindsEveryFeatureOfANoisyCopyInAnotherOrder) {
    const auto candidate = random_features(150, 1);
    Rng rng(2);
    std::vector<Feature> query;
    for (const Feature& feature : candidate)
        query.push_back({feature.pixel_px, testing::with_flips(feature.descriptor, 25, rng)});
    std::reverse(query.begin(), query.end());
    const auto matches = match_features({}, candidate, query);
    ASSERT_EQ(matches.size(), candidate.size());
    for (const FeatureMatch& match : matches) EXPECT_EQ(match.query, 149 - match.candidate);
}

TEST(FeatureMatching, FindsNothingBetweenStrangers) {
    EXPECT_TRUE(match_features({}, random_features(150, 1), random_features(150, 2)).empty());
    EXPECT_TRUE(match_features({}, {}, random_features(5, 2)).empty());
    EXPECT_TRUE(match_features({}, random_features(5, 2), {}).empty());
}

TEST(FeatureMatching, WhatIsThereTwiceTellsNothingUnlessItIsTheSameCornerOnceMore) {
    const auto candidate = random_features(20, 1);
    auto query = candidate;
    query.push_back(query[7]);
    query.back().pixel_px.x() += 5.0F;
    EXPECT_EQ(match_features({}, candidate, query).size(), 20U);
    query.back().pixel_px.x() += 50.0F;
    const auto matches = match_features({}, candidate, query);
    EXPECT_EQ(matches.size(), 19U);
    EXPECT_TRUE(std::none_of(
        matches.begin(), matches.end(), [](const FeatureMatch& m) { return m.candidate == 7; }));
    // The same features in the other image.
    EXPECT_EQ(match_features({}, query, candidate).size(), 19U);
}

}  // namespace
}  // namespace surefoot::place_recognition
