// SPDX-License-Identifier: Apache-2.0
// Rendered boards with known positions of their points, and real boards.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <opencv2/core/utility.hpp>

#include "studies/board_calibration/rendered_boards.hpp"
#include "surefoot/calibration/boards/board_print.hpp"
#include "surefoot/calibration/boards/detect_board.hpp"
#include "surefoot/calibration/boards/disc_image.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/sim/rendering/board_renderer.hpp"

namespace surefoot::app {
namespace {

using calibration::Board;
using calibration::BoardSighting;
using calibration::BoardView;

/// As in the program, only the executor creates threads.
class OpencvOnOneThread : public ::testing::Environment {
  public:
    void SetUp() override { cv::setNumThreads(1); }
};
const auto* const kOpencvOnOneThread =
    ::testing::AddGlobalTestEnvironment(new OpencvOnOneThread);  // googletest deletes it

constexpr int kPoses = 2;

Board board_of(const std::string& text) {
    return calibration::parse_board(text).value();
}

const char* const kBoards[] = {"chessboard:9x6:0.025",
                               "circles:8x5:0.03",
                               "asymmetric_circles:4x11:0.05",
                               "charuco:5x4:0.04:0.026"};

camera::Camera pinhole() {
    return {camera::PinholeRadTan{.fx_px = 540.0,
                                  .fy_px = 538.0,
                                  .cx_px = 325.0,
                                  .cy_px = 236.0,
                                  .k1 = -0.28,
                                  .k2 = 0.08,
                                  .p1 = 2e-4,
                                  .p2 = -1e-4},
            640,
            480};
}

camera::Camera fisheye() {
    return {camera::KannalaBrandt{.fx_px = 300.0,
                                  .fy_px = 300.0,
                                  .cx_px = 395.0,
                                  .cy_px = 305.0,
                                  .k1 = 0.0121,
                                  .k2 = 0.0056,
                                  .k3 = -0.0061,
                                  .k4 = 0.0005},
            800,
            600};
}

GreyImage rendered(const Board& board,
                   const camera::Camera& camera,
                   const Pose& T_camera_board,
                   const sim::ImagingConditions& observation = {}) {
    Serial serial;
    return sim::render_board(
        calibration::print_of(board).value(), camera, T_camera_board, observation, 5, serial);
}

std::vector<Pose> poses_for(const Board& board, const camera::Camera& camera, int count) {
    Rng rng(11);
    const BoardCamera this_camera{camera, Pose{}};
    return shown_poses(board, {&this_camera, 1}, count, rng);
}

/// True image of a board point; for a disc its centre of gravity.
Eigen::Vector2d image_of(const camera::Camera& camera,
                         const Pose& T_camera_board,
                         const Eigen::Vector3d& point_m,
                         double disc_radius_m) {
    const auto seen = [&](double x, double y, double* pixel) {
        const auto at = camera::project(
            camera.model, T_camera_board * (point_m + disc_radius_m * Eigen::Vector3d(x, y, 0.0)));
        if (at) std::copy(at->begin(), at->end(), pixel);
        return at.has_value();
    };
    Eigen::Vector2d pixel = Eigen::Vector2d::Constant(std::nan(""));
    if (disc_radius_m > 0.0)
        (void)calibration::disc_image<double>(seen, pixel.data());
    else
        (void)seen(0.0, 0.0, pixel.data());
    return pixel;
}

/// Distances between the detected points and the true images of the points with the same id.
std::vector<double> errors_px(const Board& board,
                              const camera::Camera& camera,
                              const Pose& T_camera_board,
                              const BoardView& view) {
    const auto points_m = board.points_m();
    const auto discs = calibration::print_of(board)->discs;
    const double radius_m = discs.empty() ? 0.0 : discs.front().radius_m;
    std::vector<double> errors;
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
        const Eigen::Vector3d& p_m = points_m[static_cast<std::size_t>(view.ids[i])];
        const Eigen::Vector2d truth = image_of(camera, T_camera_board, p_m, radius_m);
        errors.push_back((view.pixels[i] - truth).norm());
    }
    return errors;
}

double mean(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

/// Checks the mean error over several poses of every board and lens.
void expect_found(const sim::ImagingConditions& observation, double limit_px) {
    for (const char* text : kBoards) {
        const Board board = board_of(text);
        for (const camera::Camera& camera : {pinhole(), fisheye()}) {
            const auto poses = poses_for(board, camera, kPoses);
            ASSERT_EQ(std::ssize(poses), kPoses) << text;
            std::vector<double> all;
            for (const Pose& T_camera_board : poses) {
                const GreyImage image = rendered(board, camera, T_camera_board, observation);
                const BoardSighting sighting = calibration::detect_board(board, image.view());
                ASSERT_TRUE(sighting.found()) << text << ": " << sighting.problem;
                // Markers of a ChArUco board may be too small to read in a corner of the image.
                const bool parts = board.kind == calibration::BoardKind::charuco;
                EXPECT_GE(sighting.view.ids.size(),
                          parts ? std::size_t{calibration::kFewestCharucoPoints}
                                : board.points_m().size())
                    << text;
                const auto errors = errors_px(board, camera, T_camera_board, sighting.view);
                all.insert(all.end(), errors.begin(), errors.end());
            }
            std::printf("%s, %s: mean %.4f px, largest %.4f px\n",
                        text,
                        camera.width == 640 ? "pinhole" : "fisheye",
                        mean(all),
                        *std::max_element(all.begin(), all.end()));
            EXPECT_LT(mean(all), limit_px) << text;
        }
    }
}

TEST(RenderedBoard, AllKindsAreFoundToATenthOfAPixelByBothLenses) {
    expect_found({}, 0.1);
}

TEST(RenderedBoard, BlurAndNoiseCostLittle) {
    sim::ImagingConditions observation;
    observation.blur_sigma_px = 0.8;
    observation.noise_dn = 2.0;
    expect_found(observation, 0.1);
}

TEST(RenderedBoard, BigCirclesSeenAtASlantAreFoundWithTheirRadius) {
    // The images of their centres are 0.2 px away.
    const Board board = board_of("circles:6x5:0.04");
    const Pose T_camera_board{exp_so3({0.0, 0.9, 0.0}), {-0.06, -0.08, 0.45}};
    const GreyImage image = rendered(board, pinhole(), T_camera_board);
    const BoardSighting sighting = calibration::detect_board(board, image.view());
    ASSERT_TRUE(sighting.found()) << sighting.problem;
    // 8-bit grey values on the rim limit the accuracy of sharp discs of this size to 0.005 px.
    constexpr double kGreySteps_px = 0.02;
    EXPECT_LT(mean(errors_px(board, pinhole(), T_camera_board, sighting.view)), kGreySteps_px);
    // A hundredth of the radius moves a calibrated picture by a hundredth of a pixel.
    EXPECT_NEAR(sighting.view.disc_radius_m, 0.01, 1e-4);
}

TEST(RenderedBoard, PartOfACharucoIsEnough) {
    const Board board = board_of("charuco:8x5:0.03:0.022");
    // The left third is outside the image.
    const Pose T_camera_board{exp_so3({0.1, -0.2, 0.05}), {-0.22, -0.06, 0.35}};
    const GreyImage image = rendered(board, pinhole(), T_camera_board);
    const BoardSighting sighting = calibration::detect_board(board, image.view());
    ASSERT_TRUE(sighting.found()) << sighting.problem;
    EXPECT_LT(sighting.view.ids.size(), board.points_m().size());
    EXPECT_GT(sighting.view.ids.size(), 10U);
    EXPECT_TRUE(std::is_sorted(sighting.view.ids.begin(), sighting.view.ids.end()));
    EXPECT_LT(mean(errors_px(board, pinhole(), T_camera_board, sighting.view)), 0.1);
}

TEST(RenderedBoard, BoardsUpsideDownKeepTheirNumbersWhereTheyCan) {
    for (const char* text :
         {"chessboard:8x5:0.03", "asymmetric_circles:4x11:0.05", "charuco:8x5:0.03:0.022"}) {
        const Board board = board_of(text);
        ASSERT_EQ(calibration::turns_of(board).size(), 1U) << text;
        const Pose upside_down{exp_so3({0.0, 0.0, 3.0}), {0.1, 0.08, 0.6}};
        const GreyImage image = rendered(board, pinhole(), upside_down);
        const BoardSighting sighting = calibration::detect_board(board, image.view());
        ASSERT_TRUE(sighting.found()) << text << ": " << sighting.problem;
        EXPECT_LT(mean(errors_px(board, pinhole(), upside_down, sighting.view)), 0.1) << text;
    }
}

TEST(RenderedBoard, EyesOfARigAgreeOnBoardsThatLookAlikeWhenTurned) {
    for (const char* text : {"chessboard:7x5:0.03", "circles:6x6:0.03"}) {
        const Board board = board_of(text);
        ASSERT_GT(calibration::turns_of(board).size(), 1U) << text;
        // Rows run almost straight down; one camera is rotated a little more than the other.
        for (const double turn_rad : {1.55, -1.55}) {
            const Pose T_left_board{
                exp_so3({0.0, 0.0, turn_rad}),
                {turn_rad > 0.0 ? 0.05 : -0.05, turn_rad > 0.0 ? -0.07 : 0.07, 0.5}};
            const Pose T_right_left{exp_so3({0.0, 0.0, 0.05}), {-0.02, 0.0, 0.0}};
            const auto left =
                calibration::detect_board(board, rendered(board, pinhole(), T_left_board).view());
            const auto right = calibration::detect_board(
                board, rendered(board, pinhole(), T_right_left * T_left_board).view());
            ASSERT_TRUE(left.found() && right.found()) << text;
            const BoardView agreed = calibration::turned_like(board, left.view, right.view);
            EXPECT_EQ(agreed.ids, left.view.ids);
            for (std::size_t i = 0; i < agreed.pixels.size(); ++i)
                EXPECT_LT((agreed.pixels[i] - left.view.pixels[i]).norm(), 60.0) << text;
        }
    }
}

TEST(RenderedBoard, WhatShowsNoBoardGivesNone) {
    for (const char* text : kBoards) {
        const Board board = board_of(text);
        const GreyImage empty[] = {GreyImage(),
                                   GreyImage(1, 1, 128),
                                   GreyImage(7, 400, 10),
                                   GreyImage(320, 240, 0),
                                   GreyImage(320, 240, 255)};
        for (const GreyImage& image : empty) {
            const auto sighting = calibration::detect_board(board, image.view());
            EXPECT_FALSE(sighting.found()) << text;
            EXPECT_TRUE(sighting.view.ids.empty() && sighting.view.pixels.empty());
        }
        const Pose far{Eigen::Quaterniond::Identity(), {-0.1, -0.1, 12.0}};
        EXPECT_FALSE(
            calibration::detect_board(board, rendered(board, pinhole(), far).view()).found())
            << text;
        sim::ImagingConditions blurred;
        blurred.blur_sigma_px = 20.0;
        const Pose near{Eigen::Quaterniond::Identity(), {-0.1, -0.07, 0.5}};
        EXPECT_FALSE(
            calibration::detect_board(board, rendered(board, pinhole(), near, blurred).view())
                .found())
            << text;
        sim::ImagingConditions noise;
        noise.paper_dn = noise.ink_dn = 100.0;
        noise.noise_dn = 40.0;
        EXPECT_FALSE(
            calibration::detect_board(board, rendered(board, pinhole(), near, noise).view())
                .found())
            << text;
    }
}

// ---- real images --------------------------------------------------------------------------------

std::string data_folder(const std::string& name) {
    const char* folder = std::getenv("SUREFOOT_DATA_DIR");
    return std::string(folder != nullptr ? folder : SUREFOOT_DEFAULT_DATA_DIR) + "/calibration/" +
           name;
}

bool has_data(const std::string& folder) {
    if (std::filesystem::exists(folder)) return true;
    std::printf("skipped 1 check: %s is not there (set SUREFOOT_DATA_DIR)\n", folder.c_str());
    return false;
}

/// Only every `step`-th image, to save time.
int found_in(const std::string& folder, const Board& board, std::size_t step) {
    int found = 0;
    const auto names = io::list_files(folder, {".jpg", ".pgm"});
    for (std::size_t i = 0; i < names.value().size(); i += step) {
        const std::string& name = names.value()[i];
        const auto image = io::read_grey_image(io::join_path(folder, name));
        const auto sighting = calibration::detect_board(board, image.value().view());
        if (!sighting.found()) std::printf("%s: %s\n", name.c_str(), sighting.problem.c_str());
        found += sighting.found() ? 1 : 0;
    }
    return found;
}

TEST(RealBoard, EveryViewOfTheRealSetsIsFound) {
    struct Set {
        const char* folder;
        const char* board;
        std::size_t step;
        int views;
    };
    for (const Set& set : {Set{"chess_pinhole", "chessboard:9x6:1", 3, 9},
                           Set{"chess_fisheye", "chessboard:9x6:0.02423", 5, 12},
                           Set{"circles_symmetric", "circles:6x6:0.034", 1, 4}}) {
        const std::string folder = data_folder(set.folder);
        if (!has_data(folder)) continue;
        EXPECT_EQ(found_in(folder, board_of(set.board), set.step), set.views) << folder;
    }
}

}  // namespace
}  // namespace surefoot::app
