// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/bundle/coverage.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "surefoot/camera/camera_model.hpp"
#include "surefoot/core/pose.hpp"

namespace surefoot::calibration {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;

double radians(double degrees) {
    return degrees * std::numbers::pi / 180.0;
}

Board board() {
    return parse_board("chessboard:9x6:0.03").value();
}

/// The board, rotated about its own middle, with its middle at a pixel of an ideal camera.
BoardView view_at(double u, double v, double distance_m, const Eigen::Vector3d& turn_rad) {
    const camera::PinholeRadTan lens{
        .fx_px = 500.0, .fy_px = 500.0, .cx_px = 319.5, .cy_px = 239.5};
    const auto points_m = board().points_m();
    const Eigen::Vector3d middle_m = 0.5 * (points_m.front() + points_m.back());
    Pose T_camera_board{exp_so3(turn_rad), Eigen::Vector3d::Zero()};
    T_camera_board.translation_m =
        distance_m * Eigen::Vector3d((u - 319.5) / 500.0, (v - 239.5) / 500.0, 1.0) -
        T_camera_board.rotation * middle_m;
    BoardView view;
    for (std::size_t i = 0; i < points_m.size(); ++i) {
        view.ids.push_back(static_cast<int>(i));
        view.pixels.push_back(lens.project(T_camera_board * points_m[i]).value());
    }
    return view;
}

bool advises(const Coverage& coverage, const std::string& words) {
    for (const std::string& sentence : coverage.advice) {
        if (sentence.find(words) != std::string::npos) return true;
    }
    return false;
}

std::vector<BoardView> everywhere() {
    std::vector<BoardView> views;
    for (const double u : {90.0, 230.0, 410.0, 550.0}) {
        for (const double v : {70.0, 240.0, 410.0}) views.push_back(view_at(u, v, 0.7, {}));
    }
    views.push_back(view_at(320.0, 240.0, 0.4, {}));
    for (const double sign : {-1.0, 1.0}) {
        views.push_back(view_at(320.0, 240.0, 0.5, {sign * radians(30.0), 0.0, 0.0}));
        views.push_back(view_at(320.0, 240.0, 0.5, {0.0, sign * radians(30.0), 0.0}));
    }
    return views;
}

TEST(Coverage, IsSatisfiedWithABoardShownEverywhere) {
    const Coverage coverage = coverage_of(board(), everywhere(), kWidth, kHeight);
    EXPECT_TRUE(coverage.advice.empty()) << coverage.advice.front();
    EXPECT_GT(coverage.seen_share, 0.9);
}

TEST(Coverage, TellsTiltAndDistanceOfAView) {
    struct Case {
        Eigen::Vector3d turn_rad;
        NearSide near_side;
    };
    // A rotation about x (right) by a positive angle turns y (down) towards z (forward): the lower
    // side moves away and the upper side comes nearer. About y, the right side comes nearer.
    const double tilt_rad = radians(35.0);
    for (const Case& c : {Case{{tilt_rad, 0.0, 0.0}, NearSide::top},
                          Case{{-tilt_rad, 0.0, 0.0}, NearSide::bottom},
                          Case{{0.0, tilt_rad, 0.0}, NearSide::right},
                          Case{{0.0, -tilt_rad, 0.0}, NearSide::left}}) {
        const std::vector<BoardView> views = {view_at(319.5, 239.5, 1.0, c.turn_rad)};
        const Coverage coverage = coverage_of(board(), views, kWidth, kHeight);
        ASSERT_EQ(coverage.views.size(), 1U);
        EXPECT_NEAR(coverage.views[0].tilt_deg, 35.0, 1.5);
        EXPECT_EQ(coverage.views[0].near_side, c.near_side);
        EXPECT_NEAR(coverage.views[0].spacing_px, 15.0 * std::sqrt(std::cos(tilt_rad)), 0.3);
    }
}

TEST(Coverage, NamesWhatIsMissing) {
    const std::vector<BoardView> one_place(12, view_at(120.0, 90.0, 0.8, {0.0, 0.5, 0.0}));
    const Coverage coverage = coverage_of(board(), one_place, kWidth, kHeight);
    EXPECT_TRUE(advises(coverage, "bottom right"));
    EXPECT_FALSE(advises(coverage, "the top left"));
    EXPECT_TRUE(advises(coverage, "still missing: left, top and bottom)"));
    EXPECT_TRUE(advises(coverage, "equally far away"));
    EXPECT_FALSE(advises(coverage, "usable view"));
    EXPECT_LT(coverage.seen_share, 0.3);
}

TEST(Coverage, SurvivesViewsThatAreNone) {
    const Coverage nothing = coverage_of(board(), {}, kWidth, kHeight);
    EXPECT_TRUE(advises(nothing, "0 usable views"));
    EXPECT_EQ(nothing.seen_share, 0.0);

    BoardView broken;
    broken.ids = {0, 5, 99999};
    broken.pixels = {{1.0, 1.0}, {std::nan(""), 4.0}, {-5.0, 1e9}};
    BoardView point;
    for (int id = 0; id < 54; ++id) {
        point.ids.push_back(id);
        point.pixels.emplace_back(5.0, 5.0);
    }
    const std::vector<BoardView> views = {broken, point, BoardView{}};
    const Coverage coverage = coverage_of(board(), views, kWidth, kHeight);
    EXPECT_EQ(coverage.views.size(), 3U);
    EXPECT_TRUE(advises(coverage, "0 usable views"));
}

}  // namespace
}  // namespace surefoot::calibration
