// SPDX-License-Identifier: Apache-2.0
// Chessboards through wide lenses: detection, right numbering, and sub-pixel accuracy.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "surefoot/calibration/boards/chess_corners.hpp"
#include "surefoot/calibration/boards/detect_board.hpp"
#include "surefoot/calibration/boards/wide_boards_testing.hpp"

namespace surefoot::calibration {
namespace {

using testing::WideImagingConditions;
using testing::WideProfile;

const Board kBoard{.columns = 9, .rows = 6, .spacing_m = 0.025};
constexpr ImageSize kSize{480, 360};
constexpr double kLeastStep_px = 6.0;
constexpr double kMostTilt_deg = 60.0;

struct Case {
    WideProfile profile;
    double fov_deg;
    std::size_t look;
};

class WideBoards : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Lenses,
                         WideBoards,
                         ::testing::Values(Case{WideProfile::rational, 120.0, 0},
                                           Case{WideProfile::equidistant, 100.0, 1},
                                           Case{WideProfile::stereographic, 120.0, 2},
                                           Case{WideProfile::bought, 140.0, 3},
                                           Case{WideProfile::equisolid, 160.0, 4},
                                           Case{WideProfile::equidistant, 170.0, 5}),
                         [](const auto& now) {
                             std::string name = testing::kWideLooks[now.param.look].name;
                             std::replace(name.begin(), name.end(), ' ', '_');
                             return name;
                         });

TEST_P(WideBoards, AreFoundAndNumberedWhereverTheyAre) {
    const Case& c = GetParam();
    const auto camera = testing::wide_camera(c.profile, c.fov_deg, kSize);
    for (std::uint64_t seed = 501; seed < 504; ++seed) {
        Rng rng(seed);
        const Pose T = testing::wide_pose(kBoard, camera, kMostTilt_deg, kLeastStep_px, rng);
        const auto truth = testing::true_corners(kBoard, camera, T, kLeastStep_px).value();
        const GreyImage image =
            testing::wide_picture(kBoard, camera, T, testing::kWideLooks[c.look], seed);
        const BoardSighting sighting = detect_board(kBoard, image.view());
        ASSERT_TRUE(sighting.found()) << "seed " << seed << ": " << sighting.problem;
        double square = 0.0;
        for (std::size_t i = 0; i < sighting.view.ids.size(); ++i) {
            const Eigen::Vector2d error_px =
                sighting.view.pixels[i] - truth[static_cast<std::size_t>(sighting.view.ids[i])];
            EXPECT_LT(error_px.norm(), 1.5) << "seed " << seed << " point " << sighting.view.ids[i];
            square += error_px.squaredNorm();
        }
        EXPECT_LT(std::sqrt(square / static_cast<double>(sighting.view.ids.size())), 0.25)
            << "seed " << seed;
    }
}

/// A board straight ahead of a lens of 120 deg, at `distance` times its own length.
GreyImage picture_ahead(const Board& board, double distance, double turn_rad = 0.0) {
    const auto camera = testing::wide_camera(WideProfile::equidistant, 120.0, kSize);
    Pose T;
    T.rotation = Eigen::Quaterniond(exp_so3({0.1, 0.15, turn_rad}));
    T.translation_m = Eigen::Vector3d(0.0, 0.0, distance * board.columns * board.spacing_m) -
                      T.rotation * (0.5 * board.points_m().back());
    return testing::wide_picture(board, camera, T, testing::kWideLooks[0], 7);
}

TEST(WideBoardsNot, APartOfALargerBoardIsNoBoard) {
    const GreyImage image = picture_ahead(kBoard, 0.8);
    ASSERT_TRUE(detect_board(kBoard, image.view()).found());
    for (const Board& smaller : {Board{.columns = 8, .rows = 6, .spacing_m = 0.025},
                                 Board{.columns = 7, .rows = 5, .spacing_m = 0.025}}) {
        const BoardSighting sighting = detect_board(smaller, image.view());
        EXPECT_FALSE(sighting.found()) << smaller.columns;
        EXPECT_NE(sighting.problem.find("9 x 6 inner corners"), std::string::npos)
            << sighting.problem;
    }
    const Board larger{.columns = 10, .rows = 6, .spacing_m = 0.025};
    const BoardSighting sighting = detect_board(larger, image.view());
    EXPECT_FALSE(sighting.found());
    EXPECT_NE(sighting.problem.find("a part of"), std::string::npos) << sighting.problem;
}

TEST(WideBoardsNot, ImagesWithoutABoardGiveNone) {
    const Board small{.columns = 4, .rows = 3, .spacing_m = 0.03};
    for (std::uint64_t seed = 601; seed < 609; ++seed) {
        Rng rng(seed);
        const cv::Mat drawn = testing::clutter(kSize, rng);  // contains chequers of 3 x 3
        GreyImage image(kSize.width, kSize.height);
        for (int v = 0; v < kSize.height; ++v)
            for (int u = 0; u < kSize.width; ++u)
                image.row(v)[u] = static_cast<std::uint8_t>(std::clamp(
                    static_cast<double>(drawn.at<float>(v, u)) + 4.0 * rng.normal(), 0.0, 255.0));
        EXPECT_FALSE(detect_board(small, image.view()).found()) << "seed " << seed;
        EXPECT_FALSE(detect_board(kBoard, image.view()).found()) << "seed " << seed;
    }
}

TEST(WideBoardsHidden, SingleCornersMayHideUnderAGlint) {
    GreyImage image = picture_ahead(kBoard, 0.7, 0.3);
    const BoardSighting whole = detect_board(kBoard, image.view());
    ASSERT_TRUE(whole.found());
    ASSERT_EQ(whole.view.ids.size(), 54U);
    for (const std::size_t hidden : {20U, 21U, 38U}) {
        const Eigen::Vector2d& at = whole.view.pixels[hidden];
        for (int v = -7; v <= 7; ++v)
            for (int u = -7; u <= 7; ++u)
                if (u * u + v * v <= 49)
                    image.row(static_cast<int>(at.y()) + v)[static_cast<int>(at.x()) + u] = 252;
    }
    const BoardSighting sighting = detect_board(kBoard, image.view());
    ASSERT_TRUE(sighting.found()) << sighting.problem;
    EXPECT_EQ(sighting.view.ids.size(), 51U);
    for (std::size_t i = 0; i < sighting.view.ids.size(); ++i) {
        const auto id = static_cast<std::size_t>(sighting.view.ids[i]);
        EXPECT_LT((sighting.view.pixels[i] - whole.view.pixels[id]).norm(), 0.2) << id;
    }
}

TEST(WideBoardsHidden, OfTwoBoardsTheLargerInTheImageCounts) {
    GreyImage image = picture_ahead(kBoard, 1.2);
    const GreyImage far = picture_ahead(kBoard, 3.0);
    const BoardSighting alone = detect_board(kBoard, image.view());
    ASSERT_TRUE(alone.found());
    ASSERT_TRUE(detect_board(kBoard, far.view()).found());
    // A copy, as on a screen at the left border of the image.
    const int from_u = kSize.width / 2 - 60;
    const int from_v = kSize.height / 2 - 45;
    for (int v = 0; v < 90; ++v)
        for (int u = 0; u < 120; ++u) image.row(v + 250)[u] = far.row(v + from_v)[u + from_u];
    const BoardSighting sighting = detect_board(kBoard, image.view());
    ASSERT_TRUE(sighting.found()) << sighting.problem;
    for (std::size_t i = 0; i < sighting.view.ids.size(); ++i)
        ASSERT_LT((sighting.view.pixels[i] - alone.view.pixels[i]).norm(), 0.5) << i;
}

TEST(ChessCorners, TellWhichSquaresAreBlack) {
    GreyImage image(60, 60, 200);
    for (int v = 0; v < 60; ++v)
        for (int u = 0; u < 60; ++u)
            if ((u >= 30) == (v >= 30)) image.row(v)[u] = 40;
    const auto corners = chess_corners(image.view());
    ASSERT_EQ(corners.size(), 1U);
    EXPECT_LT((corners[0].pixel - Eigen::Vector2d(29.5, 29.5)).norm(), 0.5);
    // The square from its first edge onwards to its second one is black: to the right and below.
    const Eigen::Vector2d into = corners[0].edges[0] + corners[0].edges[1];
    EXPECT_GT(into.x() * into.y(), 0.0);
    EXPECT_GT(corners[0].contrast_dn, 100.0);
    GreyImage edge(60, 60, 200);
    for (int v = 0; v < 60; ++v)
        for (int u = 30; u < 60; ++u) edge.row(v)[u] = 40;
    EXPECT_TRUE(chess_corners(edge.view()).empty()) << "an edge is no corner";
    EXPECT_TRUE(chess_corners(GreyImage(3, 3, 9).view()).empty());
}

}  // namespace
}  // namespace surefoot::calibration
