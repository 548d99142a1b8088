// SPDX-License-Identifier: Apache-2.0
#include "service/page/show.hpp"

#include <gtest/gtest.h>

namespace surefoot::page {
namespace {

void hand_over(PageFeed& feed, std::uint64_t serial, std::int64_t images_time_ns) {
    PageFrame& frame = feed.blank();
    frame.serial = serial;
    frame.pose.time_ns = static_cast<std::int64_t>(serial);
    frame.images_time_ns = images_time_ns;
    if (images_time_ns != 0) frame.left = GreyImage(32, 16, static_cast<std::uint8_t>(serial));
    feed.hand_over();
}

TEST(Show, KeepsTheNewestImageWhenFramesWithoutOneFollow) {
    PageFeed feed;
    Show show;
    hand_over(feed, 1, 7);
    show.update(feed, 0);
    const std::string first = show.jpeg(PageImage::left);
    hand_over(feed, 100, 8);
    show.update(feed, 0);
    const std::uint64_t serial = show.images_serial;
    for (std::uint64_t later : {101U, 102U, 103U}) {
        hand_over(feed, later, 0);
        show.update(feed, 0);
    }
    EXPECT_EQ(show.serial(), 103U);
    EXPECT_EQ(show.images_serial, serial);
    EXPECT_EQ(show.images_time_ns(), 8);
    EXPECT_EQ(show.picture(PageImage::left).substr(0, 16), image_message(8, PageImage::left, ""));
    EXPECT_NE(show.jpeg(PageImage::left), first) << "of the second image";
    EXPECT_TRUE(show.jpeg(PageImage::disparity).empty());
}

TEST(Show, SaysWhenNoFrameComes) {
    PageFeed feed;
    Show show;
    EXPECT_EQ(show.status(0, 3, std::nullopt).state, SourceState::waiting);
    feed.blank().status.state = SourceState::running;
    hand_over(feed, 1, 0);
    show.update(feed, 0);
    EXPECT_EQ(show.status(900'000'000, 3, std::nullopt).state, SourceState::running);
    const PageStatus late = show.status(2'100'000'000, 3, std::nullopt);
    EXPECT_EQ(late.state, SourceState::waiting);
    EXPECT_EQ(late.text, "no frame has arrived for 2 s");
    EXPECT_EQ(late.viewers, 3);
    EXPECT_EQ(show.status(0, 3, PlaybackState{0, 9, true, 1.0}).state, SourceState::paused);
}

}  // namespace
}  // namespace surefoot::page
