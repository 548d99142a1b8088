// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/frame_integrity_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "surefoot/core/rng.hpp"

namespace surefoot::camera {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;

/// A still scene: always the same gradient, plus noise of about one grey level.
GreyImage exposure(Rng& rng) {
    GreyImage image(kWidth, kHeight);
    for (int v = 0; v < kHeight; ++v) {
        for (int u = 0; u < kWidth; ++u) {
            image.at(u, v) = static_cast<std::uint8_t>(50 + u + v + static_cast<int>(rng.below(3)));
        }
    }
    return image;
}

StereoFrame exposed(Rng& rng) {
    StereoFrame frame;
    frame.left = exposure(rng);
    frame.right = exposure(rng);
    return frame;
}

/// The first `rows` rows of `top`, then the other rows of `bottom`.
GreyImage spliced(const GreyImage& top, const GreyImage& bottom, int rows) {
    GreyImage image = bottom;
    std::copy(top.data(), top.row(rows), image.data());
    return image;
}

TEST(FrameIntegrityCheck, NoiseAloneMakesAStillSceneNew) {
    Rng rng(1);
    FrameIntegrityCheck watch;
    for (int i = 0; i < 200; ++i) {
        const FrameStatus frame_status = watch.check(exposed(rng));
        EXPECT_TRUE(frame_status.is_new_and_whole()) << "frame " << i;
    }
}

TEST(FrameIntegrityCheck, CountsRepeatedFramesInARow) {
    Rng rng(2);
    FrameIntegrityCheck watch;
    const StereoFrame frozen = exposed(rng);
    for (int i = 0; i < 20; ++i) EXPECT_EQ(watch.check(frozen).repeated, i);
    EXPECT_EQ(watch.check(exposed(rng)).repeated, 0);
    EXPECT_EQ(watch.check(frozen).repeated, 1) << "an older buffer comes once more";
}

TEST(FrameIntegrityCheck, ForgetsWhatIsLongAgo) {
    Rng rng(3);
    FrameIntegrityCheck watch;
    const StereoFrame first = exposed(rng);
    (void)watch.check(first);
    for (std::size_t i = 0; i < FrameIntegrityCheck::kMemory; ++i) (void)watch.check(exposed(rng));
    EXPECT_EQ(watch.check(first).repeated, 0);
}

TEST(FrameIntegrityCheck, FindsATearAtAnyRow) {
    for (int rows = 0; rows <= kHeight; ++rows) {
        for (const bool new_on_top : {true, false}) {
            Rng rng(4);
            FrameIntegrityCheck watch;
            const StereoFrame before = exposed(rng);
            const StereoFrame after = exposed(rng);
            StereoFrame frame = after;
            frame.left = new_on_top ? spliced(after.left, before.left, rows)
                                    : spliced(before.left, after.left, rows);
            frame.right = new_on_top ? spliced(after.right, before.right, rows)
                                     : spliced(before.right, after.right, rows);
            (void)watch.check(before);
            const FrameStatus frame_status = watch.check(frame);
            const int old_rows = new_on_top ? kHeight - rows : rows;
            EXPECT_EQ(frame_status.repeated, old_rows == kHeight ? 1 : 0) << rows;
            EXPECT_EQ(frame_status.torn,
                      old_rows >= FrameIntegrityCheck::kMinTornRows &&
                          kHeight - old_rows >= FrameIntegrityCheck::kMinTornRows)
                << rows << " rows, new on top: " << new_on_top;
        }
    }
}

TEST(FrameIntegrityCheck, FindsTheFrameOfOneRoundOfBuffersAgo) {
    Rng rng(5);
    FrameIntegrityCheck watch;
    const StereoFrame old = exposed(rng);
    (void)watch.check(old);
    for (int i = 0; i < 4; ++i) EXPECT_FALSE(watch.check(exposed(rng)).torn);
    StereoFrame frame = exposed(rng);
    frame.left = spliced(frame.left, old.left, kHeight / 2);
    EXPECT_TRUE(watch.check(frame).torn);
}

TEST(FrameIntegrityCheck, OneOldEyeIsATornPair) {
    Rng rng(6);
    FrameIntegrityCheck watch;
    const StereoFrame before = exposed(rng);
    (void)watch.check(before);
    StereoFrame frame = exposed(rng);
    frame.right = before.right;
    const FrameStatus frame_status = watch.check(frame);
    EXPECT_TRUE(frame_status.torn);
    EXPECT_EQ(frame_status.repeated, 0);
}

TEST(FrameIntegrityCheck, SaturatedRowsAreNoTear) {
    Rng rng(7);
    FrameIntegrityCheck watch;
    for (int i = 0; i < 10; ++i) {
        StereoFrame frame = exposed(rng);
        for (GreyImage* image : {&frame.left, &frame.right}) {
            std::fill(image->row(kHeight / 2), image->data() + image->size(), std::uint8_t{255});
        }
        EXPECT_TRUE(watch.check(frame).is_new_and_whole());
    }
}

TEST(FrameIntegrityCheck, ATearHasOneSeam) {
    Rng rng(11);
    FrameIntegrityCheck watch;
    const StereoFrame before = exposed(rng);
    (void)watch.check(before);
    StereoFrame frame = before;  // video that copies still parts, with a moving band
    for (GreyImage* image : {&frame.left, &frame.right}) {
        for (int u = 0; u < kWidth; ++u) {
            for (int v = 16; v < 32; ++v) image->at(u, v) = static_cast<std::uint8_t>(5 * u + v);
        }
    }
    EXPECT_TRUE(watch.check(frame).is_new_and_whole());
}

TEST(FrameIntegrityCheck, ACoveredEyeIsNoTornPair) {
    Rng rng(8);
    FrameIntegrityCheck watch;
    for (int i = 0; i < 10; ++i) {
        StereoFrame frame = exposed(rng);
        frame.right.fill(0);
        EXPECT_TRUE(watch.check(frame).is_new_and_whole());
    }
}

TEST(FrameIntegrityCheck, NewDepthUnderAnOldImageIsNotRepeated) {
    Rng rng(9);
    FrameIntegrityCheck watch;
    StereoFrame frame = exposed(rng);
    frame.right = {};
    frame.depth_m = Image<float>(kWidth, kHeight, std::nanf(""));
    (void)watch.check(frame);
    EXPECT_EQ(watch.check(frame).repeated, 1) << "NaN is compared by its bits";
    frame.depth_m.at(3, 4) = 1.25F;
    EXPECT_EQ(watch.check(frame).repeated, 0);
}

TEST(FrameIntegrityCheck, ModelledFramesWithoutImagesAreAlwaysNew) {
    FrameIntegrityCheck watch;
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(watch.check(StereoFrame{}).is_new_and_whole());
}

TEST(FrameIntegrityCheck, AnotherSizeIsNew) {
    Rng rng(10);
    FrameIntegrityCheck watch;
    (void)watch.check(exposed(rng));
    StereoFrame small;
    small.left = GreyImage(32, 1);
    for (int u = 0; u < 32; ++u) small.left.at(u, 0) = static_cast<std::uint8_t>(u);
    small.right = small.left;
    EXPECT_TRUE(watch.check(small).is_new_and_whole());
    EXPECT_EQ(watch.check(small).repeated, 1);
}

TEST(FrameIntegrityCheck, DarknessIsNotOld) {
    FrameIntegrityCheck watch;
    StereoFrame dark;
    dark.left = GreyImage(kWidth, kHeight, 0);
    dark.right = dark.left;
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(watch.check(dark).is_new_and_whole()) << i;
}

TEST(FrameIntegrityCheck, WhatTheSourceSaysIsBelieved) {
    Rng rng(11);
    FrameIntegrityCheck watch;
    StereoFrame told = exposed(rng);
    told.frame_status.torn = true;
    told.frame_status.dropped = 2;
    EXPECT_TRUE(watch.check(told).torn);
    EXPECT_EQ(watch.check(told).dropped, 2);
    told.frame_status.torn = false;
    EXPECT_TRUE(watch.check(told).is_new_and_whole()) << "no earlier frame was compared";
}

}  // namespace
}  // namespace surefoot::camera
