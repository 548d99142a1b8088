// SPDX-License-Identifier: Apache-2.0
#include "surefoot/place_recognition/place_memory.hpp"

#include <gtest/gtest.h>

#include "surefoot/place_recognition/place_views_testing.hpp"

namespace surefoot::place_recognition {
namespace {

using testing::random_corners;
using testing::view_of;

constexpr double kNoise_px = 0.3;
const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();

/// Place number k lies 20 m from the previous one.
Pose T_map_place(int k) {
    return {Eigen::Quaterniond::Identity(), {20.0 * k, 0.0, 0.0}};
}

/// A keyframe in the middle of place `k`, with the appearance `look`.
Keyframe keyframe_of(int k, std::uint64_t look) {
    return {view_of(random_corners(500, look), {}, kNoise_px, 100 + look), T_map_place(k)};
}

TEST(PlaceMemory, NamesTheKeyframeAmongMany) {
    PlaceMemory memory;
    for (int k = 0; k < 12; ++k) memory.add(keyframe_of(k, static_cast<std::uint64_t>(k)));
    const Pose T_place_body{exp_so3({0.0, 0.0, -0.1}), {0.1, 0.1, 0.0}};
    for (int k = 0; k < 12; ++k) {
        const auto view =
            view_of(random_corners(500, static_cast<std::uint64_t>(k)), T_place_body, kNoise_px, 7);
        const Answer answer = memory.recognise(view, kUp, 12);
        EXPECT_EQ(answer.refusal, Refusal::none) << k;
        EXPECT_EQ(answer.keyframe, k);
        EXPECT_EQ(answer.rival, 0.0);
        EXPECT_NE(memory.recognise(view, kUp, k).refusal, Refusal::none)
            << "the keyframe was not compared";
    }
}

TEST(PlaceMemory, TwoPlacesThatLookAlikeAreRefused) {
    PlaceMemory memory;
    memory.add(keyframe_of(0, 1));
    memory.add(keyframe_of(1, 2));
    memory.add(keyframe_of(2, 1));
    const auto view = view_of(random_corners(500, 1), {}, kNoise_px, 7);
    const Answer answer = memory.recognise(view, kUp, 3);
    EXPECT_EQ(answer.refusal, Refusal::ambiguous);
    EXPECT_GT(answer.rival, 0.8);
    // A twin that is not compared is no rival.
    EXPECT_EQ(memory.recognise(view, kUp, 2).refusal, Refusal::none);
}

TEST(PlaceMemory, SaysWhyItFoundNothing) {
    PlaceMemory memory;
    const auto view = view_of(random_corners(500, 1), {}, kNoise_px, 7);
    EXPECT_EQ(memory.recognise(view, kUp, 0).refusal, Refusal::no_candidate);
    View poor = view;
    poor.features.resize(20);
    EXPECT_EQ(memory.recognise(poor, kUp, 0).refusal, Refusal::few_features);
    memory.add(keyframe_of(0, 2));
    const Answer stranger = memory.recognise(view, kUp, 1);
    EXPECT_TRUE(stranger.refusal == Refusal::no_candidate ||
                stranger.refusal == Refusal::few_matches);
}

TEST(PlaceMemory, KnowsWhatItCovers) {
    PlaceMemory memory;
    memory.add(keyframe_of(1, 1));
    EXPECT_TRUE(memory.covers({Eigen::Quaterniond::Identity(), {20.2, 0.0, 0.0}}, 0.25, 12.0));
    EXPECT_FALSE(memory.covers({Eigen::Quaterniond::Identity(), {20.3, 0.0, 0.0}}, 0.25, 12.0));
    EXPECT_FALSE(memory.covers({exp_so3({0.0, 0.0, 0.3}), {20.0, 0.0, 0.0}}, 0.25, 12.0));
    memory.move(0, T_map_place(0));
    EXPECT_FALSE(memory.covers(T_map_place(1), 0.25, 12.0));
}

}  // namespace
}  // namespace surefoot::place_recognition
