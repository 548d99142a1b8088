// SPDX-License-Identifier: Apache-2.0
// Every kind of source that `calibrate` reads: folders, side-by-side images, videos.
#include "studies/board_calibration/board_images.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "surefoot/io/file.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::app {
namespace {

using io::testing::TemporaryFolder;

constexpr int kWidth = 32;  // width of one image
constexpr int kHeight = 24;
constexpr int kJpegError = 6;  // grey values

struct Given {
    std::vector<BoardImages> images;
    std::vector<std::string> notes;
    std::string error;
};

Given given(const std::string& source, bool stereo, const std::string& camera = "") {
    Given all;
    const auto about = for_board_images(source, stereo, camera, [&](BoardImages images) {
        all.images.push_back(std::move(images));
    });
    if (about) {
        all.notes = about->notes;
    } else {
        all.error = about.error().message;
    }
    return all;
}

void write_grey(const std::string& path, int grey, int width = kWidth) {
    const GreyImage image(width, kHeight, static_cast<std::uint8_t>(grey));
    ASSERT_TRUE(io::write_png(path, image)) << path;
}

/// In frame i all pixels of the left half have grey 2 i, those of the right half grey 200.
void write_video(const std::string& path, int frames, int width = 2 * kWidth) {
    const int code = cv::VideoWriter::fourcc('M', 'J', 'P', 'G');
    cv::VideoWriter writer(path, code, 5.0, cv::Size(width, kHeight), true);
    ASSERT_TRUE(writer.isOpened());
    for (int i = 0; i < frames; ++i) {
        cv::Mat image(kHeight, width, CV_8UC3, cv::Scalar::all(2 * i));
        image.colRange(width / 2, width).setTo(cv::Scalar::all(200));
        writer.write(image);
    }
}

TEST(BoardImages, OfAFolderComeInNaturalOrder) {
    const TemporaryFolder folder;
    for (const int i : {10, 9, 1}) write_grey(folder / (std::to_string(i) + ".png"), i);
    const Given all = given(folder.path(), false);
    ASSERT_EQ(all.images.size(), 3U) << all.error;
    EXPECT_EQ(all.images[0].name, "1.png");
    EXPECT_EQ(all.images[1].left.at(3, 3), 9);
    EXPECT_EQ(all.images[2].left.at(3, 3), 10);
    EXPECT_TRUE(all.images[0].right.empty());
}

TEST(BoardImages, OfTwoCamerasInOneFolderArePairedByTheRestOfTheirNames) {
    const TemporaryFolder folder;
    for (const int i : {1, 2, 3}) write_grey(folder / fmt::format("left{}.png", i), i);
    for (const int i : {1, 3, 4}) write_grey(folder / fmt::format("right{}.png", i), 100 + i);
    const Given all = given(folder.path(), true);
    ASSERT_EQ(all.images.size(), 2U) << all.error;
    EXPECT_EQ(all.images[1].left.at(0, 0), 3);
    EXPECT_EQ(all.images[1].right.at(0, 0), 103);
    ASSERT_EQ(all.notes.size(), 2U);
    EXPECT_NE(all.notes[0].find("left2.png has no partner right2.png"), std::string::npos);
    EXPECT_NE(all.notes[1].find("1 right images have no partner"), std::string::npos);
}

TEST(BoardImages, OneCameraOfTwoMustBeNamed) {
    const TemporaryFolder folder;
    write_grey(folder / "left1.png", 1);
    write_grey(folder / "right1.png", 101);
    EXPECT_NE(given(folder.path(), false).error.find("--camera"), std::string::npos);
    const Given right = given(folder.path(), false, "right");
    ASSERT_EQ(right.images.size(), 1U) << right.error;
    EXPECT_EQ(right.images[0].left.at(0, 0), 101);
}

TEST(BoardImages, OfAFolderForEachEye) {
    for (const auto& [left, right] :
         {std::pair{"left", "right"}, {"cam0", "cam1"}, {"image_0", "image_1"}}) {
        const TemporaryFolder folder;
        ASSERT_TRUE(io::make_folder(folder / left) && io::make_folder(folder / right));
        write_grey(io::join_path(folder / left, "7.png"), 7);
        write_grey(io::join_path(folder / right, "7.png"), 107);
        const Given all = given(folder.path(), true);
        ASSERT_EQ(all.images.size(), 1U) << left << ": " << all.error;
        EXPECT_EQ(all.images[0].left.at(0, 0), 7);
        EXPECT_EQ(all.images[0].right.at(0, 0), 107);
    }
}

TEST(BoardImages, SideBySideAreCutInTwo) {
    const TemporaryFolder folder;
    GreyImage both(2 * kWidth, kHeight, 5);
    both.at(kWidth - 1, 2) = 6;  // last column of the left image
    both.at(kWidth, 2) = 7;      // first column of the right image
    ASSERT_TRUE(io::write_png(folder / "a.png", both));
    const Given all = given(folder.path(), true);
    ASSERT_EQ(all.images.size(), 1U) << all.error;
    EXPECT_EQ(all.images[0].left.width(), kWidth);
    EXPECT_EQ(all.images[0].left.at(kWidth - 1, 2), 6);
    EXPECT_EQ(all.images[0].right.at(0, 2), 7);
    write_grey(folder / "b.png", 1, 2 * kWidth + 1);
    EXPECT_NE(given(folder.path(), true).error.find("even width"), std::string::npos);
}

TEST(BoardImages, OfAVideoAreSpreadOverIt) {
    const TemporaryFolder folder;
    const std::string path = folder / "boards.avi";
    write_video(path, 2 * kMostVideoViews);
    const Given all = given(path, false);
    ASSERT_EQ(all.images.size(), static_cast<std::size_t>(kMostVideoViews)) << all.error;
    EXPECT_EQ(all.images[30].name, "frame 60");
    EXPECT_EQ(all.images[30].left.width(), 2 * kWidth);
    EXPECT_NEAR(all.images[30].left.at(10, 10), 120, kJpegError);
    EXPECT_TRUE(all.images[30].right.empty());
}

TEST(BoardImages, OfASideBySideVideoAreCutInTwo) {
    const TemporaryFolder folder;
    const std::string path = folder / "boards.avi";
    write_video(path, 4);
    const Given all = given(path, true);
    ASSERT_EQ(all.images.size(), 4U) << all.error;
    EXPECT_EQ(all.images[3].left.width(), kWidth);
    EXPECT_NEAR(all.images[3].left.at(10, 10), 6, kJpegError);
    EXPECT_NEAR(all.images[3].right.at(10, 10), 200, kJpegError);
}

TEST(BoardImages, SayWhatIsMissing) {
    const TemporaryFolder folder;
    EXPECT_NE(given(folder.path(), true).error.find("left* and right*"), std::string::npos);
    EXPECT_FALSE(given(folder / "nowhere", false).error.empty());
    ASSERT_TRUE(io::write_file(folder / "broken.avi", "no video"));
    EXPECT_NE(given(folder / "broken.avi", false).error.find("broken.avi"), std::string::npos);
    ASSERT_TRUE(io::write_file(folder / "broken.png", "no image"));
    EXPECT_NE(given(folder.path(), false).error.find("broken.png"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::app
