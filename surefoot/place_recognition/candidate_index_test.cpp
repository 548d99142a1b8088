// SPDX-License-Identifier: Apache-2.0
#include "surefoot/place_recognition/candidate_index.hpp"

#include <gtest/gtest.h>

#include "surefoot/place_recognition/place_views_testing.hpp"

namespace surefoot::place_recognition {
namespace {

std::vector<Feature> features_of(int place, int flips) {
    Rng rng(static_cast<std::uint64_t>(1000 + place));
    Rng noise(static_cast<std::uint64_t>(5000 + place + 100 * flips));
    std::vector<Feature> features(300);
    for (Feature& feature : features)
        feature.descriptor = testing::with_flips(testing::random_descriptor(rng), flips, noise);
    return features;
}

TEST(CandidateIndex, NamesTheKeyframeThatWasSeenFirst) {
    CandidateIndex index;
    for (int place = 0; place < 50; ++place) index.add(place, features_of(place, 0));
    for (int place = 0; place < 50; ++place) {
        const auto found = index.find(features_of(place, 35), 50);
        ASSERT_FALSE(found.empty());
        EXPECT_EQ(found.front().keyframe, place);
        EXPECT_GT(found.front().votes, 3 * (found.size() > 1 ? found[1].votes : 0));
    }
}

TEST(CandidateIndex, AsksNoKeyframeFromTheEndOn) {
    CandidateIndex index;
    for (int place = 0; place < 10; ++place) index.add(place, features_of(place, 0));
    for (const Candidate& candidate : index.find(features_of(7, 0), 7))
        EXPECT_LT(candidate.keyframe, 7);
    EXPECT_EQ(index.find(features_of(7, 0), 8).front().keyframe, 7);
    EXPECT_TRUE(index.find(features_of(7, 0), 0).empty());
}

/// Votes of a bucket that `count` entries share, stored in chunks of fourteen.
TEST(CandidateIndex, EveryKeyframeOfABucketHasOneVoteInEachTable) {
    for (const int count : {1, 13, 14, 15, 28, 29, 199}) {
        CandidateIndex index;
        const std::vector<Feature> one(1);
        for (int keyframe = 0; keyframe < count; ++keyframe) index.add(keyframe, one);
        const auto found = index.find(one, count);
        ASSERT_EQ(found.size(), static_cast<std::size_t>(count));
        for (int keyframe = 0; keyframe < count; ++keyframe) {
            const Candidate& candidate = found[static_cast<std::size_t>(keyframe)];
            EXPECT_EQ(candidate.keyframe, keyframe) << count;
            EXPECT_EQ(candidate.votes, 8 * (50400 / count)) << count;
        }
    }
}

TEST(CandidateIndex, WhatEveryKeyframeShowsTellsNothing) {
    CandidateIndex index;
    for (int keyframe = 0; keyframe < 10; ++keyframe) {
        auto features = features_of(keyframe, 0);
        for (std::size_t i = 0; i < 30; ++i) features[i].descriptor = Descriptor{};
        index.add(keyframe, features);
    }
    const std::vector<Feature> plain(50);
    EXPECT_TRUE(index.find(plain, 10).empty());
}

}  // namespace
}  // namespace surefoot::place_recognition
