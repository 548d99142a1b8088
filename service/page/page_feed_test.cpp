// SPDX-License-Identifier: Apache-2.0
#include "service/page/page_feed.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace surefoot::page {
namespace {

void hand_over(PageFeed& feed, std::uint64_t serial) {
    feed.blank().serial = serial;
    feed.blank().pose.time_ns = static_cast<std::int64_t>(serial);
    feed.hand_over();
}

TEST(PageFeed, GivesTheNewestFrameOnce) {
    PageFeed feed;
    auto frame = std::make_unique<PageFrame>();
    EXPECT_FALSE(feed.fetch(frame));
    hand_over(feed, 1);
    hand_over(feed, 2);
    ASSERT_TRUE(feed.fetch(frame));
    EXPECT_EQ(frame->serial, 2U);
    EXPECT_FALSE(feed.fetch(frame));
    EXPECT_EQ(frame->serial, 2U) << "what was had stays";
    hand_over(feed, 3);
    EXPECT_EQ(frame->serial, 2U) << "and is nobody else's";
    ASSERT_TRUE(feed.fetch(frame));
    EXPECT_EQ(frame->serial, 3U);
}

TEST(PageFeed, TellsPerceptionWhatIsWanted) {
    PageFeed feed;
    EXPECT_FALSE(feed.wants_images());
    EXPECT_FALSE(feed.wants_layers());
    EXPECT_FALSE(feed.wants_stairs());
    feed.want(true, false, false);
    EXPECT_TRUE(feed.wants_images());
    EXPECT_FALSE(feed.wants_layers());
    EXPECT_FALSE(feed.wants_stairs());
    feed.want(false, true, false);
    EXPECT_FALSE(feed.wants_images());
    EXPECT_TRUE(feed.wants_layers());
    feed.want(false, false, true);
    EXPECT_FALSE(feed.wants_layers());
    EXPECT_TRUE(feed.wants_stairs());
}

TEST(PageFeed, FramesAreWholeWhileBothSidesAreBusy) {
    constexpr std::uint64_t kFrames = 20'000;
    PageFeed feed;
    std::thread perception([&feed] {
        for (std::uint64_t serial = 1; serial <= kFrames; ++serial) hand_over(feed, serial);
    });
    auto frame = std::make_unique<PageFrame>();
    std::uint64_t last = 0;
    while (last < kFrames) {
        if (!feed.fetch(frame)) continue;
        ASSERT_GT(frame->serial, last);
        ASSERT_EQ(frame->pose.time_ns, static_cast<std::int64_t>(frame->serial));
        last = frame->serial;
    }
    perception.join();
}

}  // namespace
}  // namespace surefoot::page
