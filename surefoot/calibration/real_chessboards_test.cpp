// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

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

BoardView corners_of(const cv::Mat& image, const Board& board) {
    std::vector<cv::Point2f> corners;
    const cv::Size size(board.columns, board.rows);
    BoardView view;
    if (!cv::findChessboardCorners(image, size, corners)) return view;
    const cv::TermCriteria criteria(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 100, 1e-4);
    cv::cornerSubPix(image, corners, cv::Size(5, 5), cv::Size(-1, -1), criteria);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        view.ids.push_back(static_cast<int>(i));
        view.pixels.emplace_back(corners[i].x, corners[i].y);
    }
    return view;
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
        const cv::Mat left = cv::imread((folder / ("left" + name)).string(), cv::IMREAD_GRAYSCALE);
        const cv::Mat right =
            cv::imread((folder / ("right" + name)).string(), cv::IMREAD_GRAYSCALE);
        pairs.size = {left.cols, left.rows};
        pairs.left.push_back(corners_of(left, board));
        pairs.right.push_back(corners_of(right, board));
    }
    return pairs;
}

/// Says what it found, so that a log shows how near the limits are.
void print(const char* set, const StereoCalibration& result) {
    std::cout << set << ": " << result.pairs.size() << " pairs, rms " << result.rms_px
              << " px, rows " << result.row_rms_px << " px at f " << result.rectified_focal_px
              << " px, baseline " << result.rig.T_left_right.translation_m.norm() << '\n';
    for (const RejectedView& pair : result.rejected)
        std::cout << "  pair " << pair.index << ": " << pair.reason << '\n';
}

double rounded(double value, int digits) {
    const double unit = std::pow(10.0, digits);
    return std::round(value * unit) / unit;
}

/// The limits are what OpenCV 4.6 reaches with the same corners and the lens of five coefficients,
/// known to the digits compared here: it is the same minimum, which nobody can get below.
TEST(RealChessboards, PinholePairIsAsGoodAsOpenCv) {
    const Board board{.spacing_m = 1.0};  // its unit is one square
    const Pairs pairs = pairs_of("chess_pinhole", board);
    if (pairs.left.empty()) GTEST_SKIP() << kNoData << "chess_pinhole in " << data_folder();
    for (const LensKind kind : {LensKind::pinhole5, LensKind::rational}) {
        const auto result = calibrate_stereo(board, pairs.left, pairs.right, pairs.size, kind);
        ASSERT_TRUE(result) << result.error().message;
        print("chess_pinhole", *result);
        EXPECT_EQ(result->pairs.size(), 13U);
        EXPECT_LE(rounded(result->rms_px, 4), 0.2150);
        EXPECT_LE(rounded(result->row_rms_px, 3), 0.165);
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
}

}  // namespace
}  // namespace surefoot::calibration
