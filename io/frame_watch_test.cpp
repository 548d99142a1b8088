// SPDX-License-Identifier: Apache-2.0
#include "io/frame_watch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "surefoot/core/rng.hpp"

namespace surefoot::io {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;

/// A still scene: the same gradient every time, and noise of a grey level or so on top.
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

/// The first `rows` rows of `top`, the others of `bottom`.
GreyImage spliced(const GreyImage& top, const GreyImage& bottom, int rows) {
    GreyImage image = bottom;
    std::copy(top.data(), top.row(rows), image.data());
    return image;
}

FrameArrival looked_at(FrameWatch& watch, const StereoFrame& frame) {
    StereoFrame copy = frame;
    watch.look(copy);
    return copy.arrival;
}

TEST(FrameWatch, NoiseAloneMakesAStillSceneNew) {
    Rng rng(1);
    FrameWatch watch;
    for (int i = 0; i < 200; ++i) {
        const FrameArrival arrival = looked_at(watch, exposed(rng));
        EXPECT_TRUE(arrival.is_new_and_whole()) << "frame " << i;
    }
}

TEST(FrameWatch, CountsRepeatedFramesInARow) {
    Rng rng(2);
    FrameWatch watch;
    const StereoFrame frozen = exposed(rng);
    for (int i = 0; i < 20; ++i) EXPECT_EQ(looked_at(watch, frozen).repeated, i);
    EXPECT_EQ(looked_at(watch, exposed(rng)).repeated, 0);
    EXPECT_EQ(looked_at(watch, frozen).repeated, 1) << "an older buffer comes once more";
}

TEST(FrameWatch, ForgetsWhatIsLongAgo) {
    Rng rng(3);
    FrameWatch watch;
    const StereoFrame first = exposed(rng);
    (void)looked_at(watch, first);
    for (std::size_t i = 0; i < FrameWatch::kMemory; ++i) (void)looked_at(watch, exposed(rng));
    EXPECT_EQ(looked_at(watch, first).repeated, 0);
}

TEST(FrameWatch, FindsATearAtAnyRow) {
    for (int rows = 0; rows <= kHeight; ++rows) {
        for (const bool new_on_top : {true, false}) {
            Rng rng(4);
            FrameWatch watch;
            const StereoFrame before = exposed(rng);
            const StereoFrame after = exposed(rng);
            StereoFrame frame = after;
            frame.left = new_on_top ? spliced(after.left, before.left, rows)
                                    : spliced(before.left, after.left, rows);
            frame.right = new_on_top ? spliced(after.right, before.right, rows)
                                     : spliced(before.right, after.right, rows);
            (void)looked_at(watch, before);
            const FrameArrival arrival = looked_at(watch, frame);
            const int old_rows = new_on_top ? kHeight - rows : rows;
            EXPECT_EQ(arrival.repeated, old_rows == kHeight ? 1 : 0) << rows;
            EXPECT_EQ(arrival.torn,
                      old_rows >= FrameWatch::kMinTornRows &&
                          kHeight - old_rows >= FrameWatch::kMinTornRows)
                << rows << " rows, new on top: " << new_on_top;
        }
    }
}

TEST(FrameWatch, FindsTheFrameOfOneRoundOfBuffersAgo) {
    Rng rng(5);
    FrameWatch watch;
    const StereoFrame old = exposed(rng);
    (void)looked_at(watch, old);
    for (int i = 0; i < 4; ++i) EXPECT_FALSE(looked_at(watch, exposed(rng)).torn);
    StereoFrame frame = exposed(rng);
    frame.left = spliced(frame.left, old.left, kHeight / 2);
    EXPECT_TRUE(looked_at(watch, frame).torn);
}

TEST(FrameWatch, OneOldEyeIsATornPair) {
    Rng rng(6);
    FrameWatch watch;
    const StereoFrame before = exposed(rng);
    (void)looked_at(watch, before);
    StereoFrame frame = exposed(rng);
    frame.right = before.right;
    const FrameArrival arrival = looked_at(watch, frame);
    EXPECT_TRUE(arrival.torn);
    EXPECT_EQ(arrival.repeated, 0);
}

TEST(FrameWatch, SaturatedRowsAreNoTear) {
    Rng rng(7);
    FrameWatch watch;
    for (int i = 0; i < 10; ++i) {
        StereoFrame frame = exposed(rng);
        for (GreyImage* image : {&frame.left, &frame.right}) {
            std::fill(image->row(kHeight / 2), image->data() + image->size(), std::uint8_t{255});
        }
        EXPECT_TRUE(looked_at(watch, frame).is_new_and_whole());
    }
}

TEST(FrameWatch, ATearHasOneSeam) {
    Rng rng(11);
    FrameWatch watch;
    const StereoFrame before = exposed(rng);
    (void)looked_at(watch, before);
    StereoFrame frame = before;  // video that copies what stands still, and a band that moves
    for (GreyImage* image : {&frame.left, &frame.right}) {
        for (int u = 0; u < kWidth; ++u) {
            for (int v = 16; v < 32; ++v) image->at(u, v) = static_cast<std::uint8_t>(5 * u + v);
        }
    }
    EXPECT_TRUE(looked_at(watch, frame).is_new_and_whole());
}

TEST(FrameWatch, ACoveredEyeIsNoTornPair) {
    Rng rng(8);
    FrameWatch watch;
    for (int i = 0; i < 10; ++i) {
        StereoFrame frame = exposed(rng);
        frame.right.fill(0);
        EXPECT_TRUE(looked_at(watch, frame).is_new_and_whole());
    }
}

TEST(FrameWatch, NewDepthUnderAnOldImageIsNotRepeated) {
    Rng rng(9);
    FrameWatch watch;
    StereoFrame frame = exposed(rng);
    frame.right = {};
    frame.depth_m = Image<float>(kWidth, kHeight, std::nanf(""));
    (void)looked_at(watch, frame);
    EXPECT_EQ(looked_at(watch, frame).repeated, 1) << "NaN is compared by its bits";
    frame.depth_m.at(3, 4) = 1.25F;
    EXPECT_EQ(looked_at(watch, frame).repeated, 0);
}

TEST(FrameWatch, ModelledFramesWithoutImagesAreAlwaysNew) {
    FrameWatch watch;
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(looked_at(watch, StereoFrame{}).is_new_and_whole());
}

TEST(FrameWatch, AnotherSizeIsNew) {
    Rng rng(10);
    FrameWatch watch;
    (void)looked_at(watch, exposed(rng));
    StereoFrame tiny;
    tiny.left = GreyImage(1, 1, 7);
    tiny.right = tiny.left;
    EXPECT_TRUE(looked_at(watch, tiny).is_new_and_whole());
    EXPECT_EQ(looked_at(watch, tiny).repeated, 1);
}

}  // namespace
}  // namespace surefoot::io
