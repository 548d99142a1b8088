// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>
#include <vector>

#include "surefoot/calibration/boards/detect_board.hpp"
#include "surefoot/calibration/stereo_calibration.hpp"

namespace surefoot::calibration {
namespace {

std::string data_folder() {
    const char* folder = std::getenv("SUREFOOT_DATA_DIR");
    return folder != nullptr ? folder : SUREFOOT_DEFAULT_DATA_DIR;
}

/// `make test` counts messages with these words.
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

/// Prints the result, so that a log shows the distance from the limits.
void print(const char* set, const StereoCalibration& result) {
    std::cout << set << ": " << result.pairs.size() << " pairs, rms " << result.rms_px
              << " px, rows " << result.row_rms_px << " px at f " << result.row_focal_px
              << " px (rectified " << result.rectified_focal_px << "), baseline "
              << result.rig.T_left_right.translation_m.norm() << '\n';
    for (const RejectedView& pair : result.rejected)
        std::cout << "  pair " << pair.index << ": " << pair.reason << '\n';
}

/// Row error in images from `camera/rectifier`. For the rational lens they are larger than the raw
/// ones.
double rectified_row_px(const StereoCalibration& result) {
    return result.row_rms_px * result.rectified_focal_px / result.row_focal_px;
}

/// The whole way from images to the rig, with our own corners. The limits are the results of OpenCV
/// 4.6 with its own corners and the lens of five coefficients.
TEST(RealChessboards, PinholePairIsAsGoodAsOpenCv) {
    const Board board{.spacing_m = 1.0};  // the unit is one square
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

/// Selects the pairs `indices` of a set.
Pairs chosen(const Pairs& pairs, const std::vector<std::size_t>& indices) {
    Pairs some;
    some.size = pairs.size;
    for (const std::size_t i : indices) {
        some.left.push_back(pairs.left[i]);
        some.right.push_back(pairs.right[i]);
    }
    return some;
}

/// Length of the baseline with its stated sigma.
std::pair<double, double> baseline_of(const StereoCalibration& result) {
    const Pose& T = result.rig.T_left_right;
    const Eigen::Vector3d along = T.R().transpose() * T.translation_m.normalized();
    const Eigen::Matrix3d block = result.covariance.bottomRightCorner<6, 6>().topLeftCorner<3, 3>();
    return {T.translation_m.norm(), std::sqrt(along.dot(block * along))};
}

/// Two halves of the pairs give two calibrations of one rig. Both contain the errors of boards that
/// are not flat, hands that move, and lenses beyond the model.
void expect_halves_to_agree(const char* set, const Board& board, LensKind kind) {
    const Pairs pairs = pairs_of(set, board);
    if (pairs.left.empty()) GTEST_SKIP() << kNoData << set << " in " << data_folder();
    const auto all = calibrate_stereo(board, pairs.left, pairs.right, pairs.size, kind);
    ASSERT_TRUE(all) << all.error().message;
    std::vector<std::size_t> halves[2];
    for (std::size_t i = 0; i < all->pairs.size(); ++i)
        halves[i % 2].push_back(all->pairs[i].index);
    std::pair<double, double> baselines[2];
    for (std::size_t half = 0; half < 2; ++half) {
        const Pairs own = chosen(pairs, halves[half]);
        const auto result = calibrate_stereo(board, own.left, own.right, own.size, kind);
        ASSERT_TRUE(result) << result.error().message;
        baselines[half] = baseline_of(*result);
        std::cout << set << " half " << half << ": baseline " << baselines[half].first << " +- "
                  << baselines[half].second << '\n';
    }
    EXPECT_LT(std::abs(baselines[0].first - baselines[1].first),
              3.0 * std::hypot(baselines[0].second, baselines[1].second));
}

TEST(RealChessboards, HalvesOfThePinholePairsAgreeWithinTheirStatedSigma) {
    expect_halves_to_agree("chess_pinhole", Board{.spacing_m = 1.0}, LensKind::pinhole5);
}

TEST(RealChessboards, HalvesOfTheFisheyePairsAgreeWithinTheirStatedSigma) {
    expect_halves_to_agree("chess_fisheye", Board{.spacing_m = 0.02423}, LensKind::fisheye);
}

}  // namespace
}  // namespace surefoot::calibration
