// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "surefoot/calibration/detect_board.hpp"
#include "surefoot/calibration/stereo_calibration.hpp"

namespace surefoot::calibration {
namespace {

std::string data_folder() {
    const char* folder = std::getenv("SUREFOOT_DATA_DIR");
    return folder != nullptr ? folder : SUREFOOT_DEFAULT_DATA_DIR;
}

/// `make test` counts these words.
constexpr const char* kNoData = "skipped 1 check: no calibration/";

struct Pairs {
    ImageSize size;
    std::vector<BoardView> left;
    std::vector<BoardView> right;
};

GreyImage grey_of(const std::filesystem::path& path) {
    const cv::Mat read = cv::imread(path.string(), cv::IMREAD_GRAYSCALE);
    GreyImage image(read.cols, read.rows);
    for (int v = 0; v < read.rows; ++v)
        std::copy(read.ptr(v), read.ptr(v) + read.cols, image.row(v));
    return image;
}

/// Views of left*.jpg and right*.jpg, by name; empty without the data.
Pairs pairs_of(const std::string& set, const Board& board) {
    const std::filesystem::path folder = data_folder() + "/calibration/" + set;
    Pairs pairs;
    if (!std::filesystem::is_directory(folder)) return pairs;
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with("left") && name.ends_with(".jpg")) names.push_back(name.substr(4));
    }
    std::sort(names.begin(), names.end());
    for (const std::string& name : names) {
        const GreyImage left = grey_of(folder / ("left" + name));
        const GreyImage right = grey_of(folder / ("right" + name));
        pairs.size = {left.width(), left.height()};
        const BoardSighting seen_left = detect_board(board, left.view());
        const BoardSighting seen_right = detect_board(board, right.view());
        pairs.left.push_back(seen_left.view);
        pairs.right.push_back(seen_left.found() && seen_right.found()
                                  ? turned_like(board, seen_left.view, seen_right.view)
                                  : seen_right.view);
    }
    return pairs;
}

/// Says what it found, so that a log shows how near the limits are.
void print(const char* set, const StereoCalibration& result) {
    std::cout << set << ": " << result.pairs.size() << " pairs, rms " << result.rms_px
              << " px, rows " << result.row_rms_px << " px at f " << result.row_focal_px
              << " px (rectified " << result.rectified_focal_px << "), baseline "
              << result.rig.T_left_right.translation_m.norm() << '\n';
    for (const RejectedView& pair : result.rejected)
        std::cout << "  pair " << pair.index << ": " << pair.reason << '\n';
}

/// In the images that `camera/rectifier` would make. The rational lens's are larger than the lens.
double rectified_row_px(const StereoCalibration& result) {
    return result.row_rms_px * result.rectified_focal_px / result.row_focal_px;
}

/// From images to the rig with our own corners. The limits are what OpenCV 4.6 reaches with its own
/// and the lens of five coefficients.
TEST(RealChessboards, PinholePairIsAsGoodAsOpenCv) {
    const Board board{.spacing_m = 1.0};  // its unit is one square
    const Pairs pairs = pairs_of("chess_pinhole", board);
    if (pairs.left.empty()) GTEST_SKIP() << kNoData << "chess_pinhole in " << data_folder();
    for (const LensKind kind : {LensKind::pinhole5, LensKind::rational}) {
        const auto result = calibrate_stereo(board, pairs.left, pairs.right, pairs.size, kind);
        ASSERT_TRUE(result) << result.error().message;
        print("chess_pinhole", *result);
        EXPECT_EQ(result->pairs.size(), 13U);
        EXPECT_LE(result->rms_px, 0.215);
        EXPECT_LE(result->row_rms_px, 0.165);
        if (kind == LensKind::pinhole5) {
            EXPECT_LE(rectified_row_px(*result), 0.165);
        }
        EXPECT_NEAR(result->rig.T_left_right.translation_m.norm(), 3.3273, 0.003);
    }
}

TEST(RealChessboards, FisheyePairsThatWereNotTakenTogetherAreFound) {
    const Board board{.spacing_m = 0.02423};
    const Pairs pairs = pairs_of("chess_fisheye", board);
    if (pairs.left.empty()) GTEST_SKIP() << kNoData << "chess_fisheye in " << data_folder();
    const auto result =
        calibrate_stereo(board, pairs.left, pairs.right, pairs.size, LensKind::fisheye);
    ASSERT_TRUE(result) << result.error().message;
    print("chess_fisheye", *result);
    EXPECT_GE(result->pairs.size(), 19U);
    EXPECT_EQ(result->pairs.size() + result->rejected.size(), 29U);
    EXPECT_LE(result->rms_px, 0.336);
    EXPECT_LE(result->row_rms_px, 0.65);
    EXPECT_LE(rectified_row_px(*result), 0.65);
}

}  // namespace
}  // namespace surefoot::calibration
