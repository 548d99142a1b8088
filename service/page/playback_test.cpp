// SPDX-License-Identifier: Apache-2.0
#include "service/page/playback.hpp"

#include <gtest/gtest.h>

namespace surefoot::page {
namespace {

PlaybackWish to_frame(int frame) {
    return {std::nullopt, std::nullopt, frame};
}

TEST(Playback, IsNothingBeforeItIsOffered) {
    Playback playback;
    playback.ask({true, 2.0, 5});
    EXPECT_FALSE(playback.state());
    EXPECT_FALSE(playback.jump_wanted());
    playback.at(3);
    EXPECT_FALSE(playback.state());
}

TEST(Playback, WhatIsMissingInAWishStays) {
    Playback playback;
    playback.offer({0, 600, false, 1.0});
    playback.ask({true, std::nullopt, std::nullopt});
    playback.ask({std::nullopt, 0.5, std::nullopt});
    EXPECT_TRUE(playback.state()->paused);
    EXPECT_EQ(playback.state()->speed, 0.5);
    EXPECT_FALSE(playback.jump_wanted());
    playback.ask({false, std::nullopt, std::nullopt});
    EXPECT_FALSE(playback.state()->paused);
    EXPECT_EQ(playback.state()->speed, 0.5);
}

TEST(Playback, AJumpIsTakenOnceAndShownAtOnce) {
    Playback playback;
    playback.offer({0, 600, false, 1.0});
    playback.at(41);
    EXPECT_EQ(playback.state()->frame, 41);
    playback.ask(to_frame(500));
    EXPECT_TRUE(playback.jump_wanted());
    EXPECT_EQ(playback.state()->frame, 500);
    playback.at(42);  // shown before the player saw the jump
    EXPECT_EQ(playback.state()->frame, 500);
    EXPECT_EQ(playback.take_jump(), 500);
    EXPECT_FALSE(playback.take_jump());
    playback.at(501);
    EXPECT_EQ(playback.state()->frame, 501);
}

TEST(Playback, JumpsStayWithinTheRecording) {
    Playback playback;
    playback.offer({0, 600, false, 1.0});
    playback.ask(to_frame(7000));
    EXPECT_EQ(playback.take_jump(), 599);
    playback.offer({0, 0, false, 1.0});
    playback.ask(to_frame(5));
    EXPECT_FALSE(playback.jump_wanted()) << "nobody knows how long it is";
}

}  // namespace
}  // namespace surefoot::page
