// SPDX-License-Identifier: Apache-2.0
#include "studies/board_calibration/live_board_images.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "surefoot/io/live_camera/fake_video_device.hpp"

namespace surefoot::app {
namespace {

using io::testing::FakeCamera;
using io::testing::FakeEvent;
using io::testing::FakeVideoDevice;

constexpr int kWidth = 16;  // width of one image
constexpr int kHeight = 8;

/// A frame every 0.4 s. All pixels of frame i have grey i in the left image, 100 + i in the right.
FakeCamera camera_with(int frames) {
    FakeCamera camera;
    camera.width = 2 * kWidth;
    camera.height = kHeight;
    camera.bytes_per_line = 4 * kWidth;
    for (int i = 0; i < frames; ++i) {
        FakeEvent event;
        for (int pixel = 0; pixel < 2 * kWidth * kHeight; ++pixel) {
            const int grey = pixel % (2 * kWidth) < kWidth ? i : 100 + i;
            event.bytes += static_cast<char>(grey);
            event.bytes += '\x80';
        }
        event.sequence = static_cast<std::uint32_t>(i);
        event.time_us = 1'000'000 + i * 400'000;
        camera.script.push_back(event);
        FakeEvent silence;
        silence.kind = FakeEvent::Kind::silence;
        camera.script.push_back(silence);
    }
    return camera;
}

struct Session {
    std::vector<BoardImages> images;
    Status status;
};

Session held(FakeCamera camera, LiveBoards session) {
    Session result;
    session.config.reconnect_s = 1.0;
    result.status = for_live_images(
        std::make_unique<FakeVideoDevice>(camera), session, [&](BoardImages images) {
            result.images.push_back(std::move(images));
        });
    return result;
}

TEST(LiveBoards, AreAPauseApartAndHaveBothEyes) {
    const Session session = held(camera_with(10), {.address = "/dev/fake@32x8", .most = 3});
    ASSERT_TRUE(session.status) << session.status.error().message;
    ASSERT_EQ(session.images.size(), 3U);
    // Frames are 0.4 s apart, so every third frame is the first one after the pause of 1 s.
    for (int i = 0; i < 3; ++i) {
        const BoardImages& images = session.images[static_cast<std::size_t>(i)];
        EXPECT_EQ(images.left.width(), kWidth);
        EXPECT_EQ(images.left.at(3, 3), 3 * i);
        EXPECT_EQ(images.right.at(3, 3), 100 + 3 * i);
    }
}

TEST(LiveBoards, OneEyeOfTwo) {
    const LiveBoards right{
        .address = "/dev/fake@32x8", .stereo = false, .camera = "right", .most = 1};
    const Session session = held(camera_with(3), right);
    ASSERT_EQ(session.images.size(), 1U);
    EXPECT_EQ(session.images[0].left.at(0, 0), 100);
    EXPECT_TRUE(session.images[0].right.empty());
}

TEST(LiveBoards, EndWhenTheyAreStopped) {
    int asked = 0;
    const LiveBoards session{
        .address = "/dev/fake@32x8", .stop = [&] { return ++asked > 2; }, .pause_s = 0.0};
    const Session ended = held(camera_with(2), session);
    EXPECT_TRUE(ended.status) << ended.status.error().message;
    EXPECT_LE(ended.images.size(), 2U);
}

TEST(LiveBoards, SayWhatIsMissing) {
    const Session no_size = held(camera_with(1), {.address = "/dev/fake"});
    ASSERT_FALSE(no_size.status);
    EXPECT_NE(no_size.status.error().message.find("WIDTHxHEIGHT"), std::string::npos);
    const Session no_camera = held(camera_with(1), {.address = "/dev/fake@32x8", .stereo = false});
    ASSERT_FALSE(no_camera.status);
    EXPECT_NE(no_camera.status.error().message.find("--camera"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::app
