// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/boards/corner_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "surefoot/calibration/boards/board_corners.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::calibration {
namespace {

constexpr int kWidth = 90;
constexpr int kHeight = 70;
constexpr double kBlur_px = 0.75;
const Board kBoard{.columns = 5, .rows = 4, .spacing_m = 1.0};

/// Maps a board position (in squares; corners at integers) into the image: an affine map, with
/// curvature in both directions.
struct Map {
    Eigen::Vector2d origin_px{22.3, 15.7};
    Eigen::Matrix2d steps_px;
    double bend_per_px = 0.0;

    [[nodiscard]] Eigen::Vector2d pixel_of(const Eigen::Vector2d& place) const {
        return bent(steps_px * place, 1.0) + origin_px;
    }
    /// Inverse by iteration: the curvature is small.
    [[nodiscard]] Eigen::Vector2d place_of(const Eigen::Vector2d& pixel) const {
        Eigen::Vector2d flat_px = pixel - origin_px;
        for (int i = 0; i < 6; ++i) flat_px = pixel - origin_px - (bent(flat_px, 1.0) - flat_px);
        return steps_px.inverse() * flat_px;
    }
    [[nodiscard]] Eigen::Vector2d bent(const Eigen::Vector2d& p, double share) const {
        return p + 0.5 * share * bend_per_px * Eigen::Vector2d(p.y() * p.y(), p.x() * p.x());
    }
};

/// An endless chessboard, blurred by a Gaussian spot; every pixel has noise of `noise_dn`.
GreyImage picture_of(const Map& map, double noise_dn, std::uint64_t seed) {
    constexpr int kHalf = 12;  // samples on each side, up to three sigma
    Rng rng(seed);
    GreyImage image(kWidth, kHeight);
    for (int v = 0; v < kHeight; ++v) {
        for (int u = 0; u < kWidth; ++u) {
            double light = 0.0;
            double weights = 0.0;
            for (int j = -kHalf; j <= kHalf; ++j) {
                for (int i = -kHalf; i <= kHalf; ++i) {
                    const Eigen::Vector2d sigmas = 3.0 / kHalf * Eigen::Vector2d(i, j);
                    const double weight = std::exp(-0.5 * sigmas.squaredNorm());
                    const Eigen::Vector2d place =
                        map.place_of(Eigen::Vector2d(u, v) + kBlur_px * sigmas);
                    const int parity = static_cast<int>(std::floor(place.x())) +
                                       static_cast<int>(std::floor(place.y()));
                    light += weight * (parity % 2 == 0 ? 30.0 : 210.0);
                    weights += weight;
                }
            }
            const double value = light / weights + noise_dn * rng.normal();
            image.row(v)[u] = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
        }
    }
    return image;
}

/// The board moves by `motion_px` during the exposure; `map` is its middle position.
GreyImage moving_picture_of(const Map& map, const Eigen::Vector2d& motion_px) {
    constexpr int kMoments = 9;
    std::vector<double> sums(static_cast<std::size_t>(kWidth * kHeight), 0.0);
    for (int i = 0; i < kMoments; ++i) {
        Map moved = map;
        moved.origin_px += ((i + 0.5) / kMoments - 0.5) * motion_px;
        const GreyImage moment = picture_of(moved, 0.0, 1);
        for (int v = 0; v < kHeight; ++v)
            for (int u = 0; u < kWidth; ++u)
                sums[static_cast<std::size_t>(v * kWidth + u)] += moment.row(v)[u];
    }
    GreyImage image(kWidth, kHeight);
    for (int v = 0; v < kHeight; ++v)
        for (int u = 0; u < kWidth; ++u)
            image.row(v)[u] = static_cast<std::uint8_t>(
                std::lround(sums[static_cast<std::size_t>(v * kWidth + u)] / kMoments));
    return image;
}

/// All corners of the board, each `off_px` from its true position, in rotating directions.
BoardView rough_view(const Map& map, double off_px) {
    BoardView view;
    for (const Eigen::Vector3d& point : kBoard.points_m()) {
        const double turn = 2.4 * static_cast<double>(view.ids.size());
        view.ids.push_back(static_cast<int>(view.ids.size()));
        view.pixels.push_back(map.pixel_of(point.head<2>()) +
                              off_px * Eigen::Vector2d(std::cos(turn), std::sin(turn)));
    }
    return view;
}

double worst_px(const Map& map, const BoardView& view) {
    const std::vector<Eigen::Vector3d> points = kBoard.points_m();
    double worst = 0.0;
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
        const auto id = static_cast<std::size_t>(view.ids[i]);
        worst = std::max(worst, (view.pixels[i] - map.pixel_of(points[id].head<2>())).norm());
    }
    return worst;
}

Map affine(double a, double b, double c, double d) {
    Map map;
    map.steps_px << a, b, c, d;
    return map;
}

TEST(CornerFit, SmallAndSlantedSquaresAreFoundToHundredthsOfAPixel) {
    // The last maps show flat squares: 4.1 px from edge to edge, much narrower than long.
    for (const Map& map :
         {affine(4.4, -0.6, 0.8, 4.2), affine(9.3, 1.7, -2.1, 8.8), affine(11.0, 2.0, 0.5, 4.2)}) {
        const GreyImage image = picture_of(map, 0.0, 1);
        BoardView view = rough_view(map, 0.4);
        fit_corners(kBoard, image.view(), view);
        EXPECT_EQ(view.ids.size(), 20U);
        EXPECT_LT(worst_px(map, view), 0.04) << map.steps_px;
    }
}

TEST(CornerFit, BentLinesDoNotMoveTheirCrossing) {
    Map map = affine(12.3, 1.1, -0.7, 11.8);
    map.bend_per_px = 1.0 / 300.0;
    const GreyImage image = picture_of(map, 0.0, 1);
    BoardView view = rough_view(map, 0.3);
    fit_corners(kBoard, image.view(), view);
    EXPECT_EQ(view.ids.size(), 20U);
    EXPECT_LT(worst_px(map, view), 0.02);
}

TEST(CornerFit, NoiseMovesItAsMuchAsTheEdgesAllow) {
    const Map map = affine(9.3, 1.7, -2.1, 8.8);
    double square = 0.0;
    double count = 0.0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const GreyImage image = picture_of(map, 6.0, seed);
        BoardView view = rough_view(map, 0.4);
        fit_corners(kBoard, image.view(), view);
        EXPECT_EQ(view.ids.size(), 20U);
        for (std::size_t i = 0; i < view.ids.size(); ++i) {
            const Eigen::Vector3d point = kBoard.points_m()[static_cast<std::size_t>(view.ids[i])];
            square += (view.pixels[i] - map.pixel_of(point.head<2>())).squaredNorm() / 2.0;
            count += 1.0;
        }
    }
    // Noise n shifts an edge of contrast 2h and length L px by n sqrt(sqrt(pi) s / L) / (2h /
    // sqrt(2)): 0.02 px for 9 px of edge in each direction.
    EXPECT_LT(std::sqrt(square / count), 0.03);
    EXPECT_GT(std::sqrt(square / count), 0.008) << "noise of 6 grey values must show";
}

TEST(CornerFit, WhatIsNoCornerLeavesTheView) {
    const Map map = affine(9.3, 1.7, -2.1, 8.8);
    GreyImage image = picture_of(map, 2.0, 1);
    const Eigen::Vector2d hidden = map.pixel_of({1.0, 2.0});
    for (int v = -4; v <= 4; ++v)
        for (int u = -4; u <= 4; ++u)
            if (u * u + v * v <= 14)
                image.row(static_cast<int>(hidden.y()) + v)[static_cast<int>(hidden.x()) + u] = 250;
    BoardView view = rough_view(map, 0.4);
    fit_corners(kBoard, image.view(), view);
    EXPECT_EQ(view.ids.size(), 19U);
    EXPECT_EQ(std::count(view.ids.begin(), view.ids.end(), 11), 0) << "hidden by a reflection";
    EXPECT_LT(worst_px(map, view), 0.1);
}

TEST(CornerFit, AGlintBesideItIsSeenInWhatTheModelLeaves) {
    // The fit converges 0.8 px from the corner, with contrast: only its residuals reveal this.
    const Map map = affine(9.3, 1.7, -2.1, 8.8);
    GreyImage image = picture_of(map, 2.0, 1);
    const Eigen::Vector2d corner = map.pixel_of({1.0, 2.0});
    const int u0 = static_cast<int>(std::lround(corner.x())) + 2;
    const int v0 = static_cast<int>(std::lround(corner.y()));
    for (int v = -2; v <= 2; ++v)
        for (int u = -2; u <= 2; ++u)
            if (u * u + v * v <= 4) image.row(v0 + v)[u0 + u] = 250;
    BoardView view = rough_view(map, 0.4);
    fit_corners(kBoard, image.view(), view);
    EXPECT_EQ(view.ids.size(), 19U);
    EXPECT_EQ(std::count(view.ids.begin(), view.ids.end(), 11), 0);
    EXPECT_LT(worst_px(map, view), 0.1);
}

TEST(CornerFit, WeakLightAndNoiseAreNoReasonToRefuse) {
    // The remaining noise is a seventh of the contrast, as in an image with little light.
    const Map map = affine(9.3, 1.7, -2.1, 8.8);
    GreyImage image = picture_of(map, 12.0, 1);
    for (int v = 0; v < kHeight; ++v)
        for (int u = 0; u < kWidth; ++u)
            image.row(v)[u] = static_cast<std::uint8_t>(20 + image.row(v)[u] / 6);
    BoardView view = rough_view(map, 0.4);
    fit_corners(kBoard, image.view(), view);
    EXPECT_EQ(view.ids.size(), 20U);
    EXPECT_LT(worst_px(map, view), 0.2);
}

TEST(CornerFit, OfAMovingBoardItIsTheMiddleOfTheExposure) {
    const Map map = affine(9.3, 1.7, -2.1, 8.8);
    const GreyImage image = moving_picture_of(map, {5.0, -3.0});  // more than half a square
    BoardView view = rough_view(map, 0.4);
    fit_corners(kBoard, image.view(), view);
    EXPECT_EQ(view.ids.size(), 20U);
    EXPECT_LT(worst_px(map, view), 0.05);
}

TEST(CornerFit, RefusesAnEdgeAFlatImageAndThePlaceOutside) {
    GreyImage image(kWidth, kHeight, 100);
    CornerGuess guess{{40.0, 40.0}, {8.0, 0.0}, {0.0, 8.0}};
    EXPECT_FALSE(fit_corner(image.view(), guess)) << "nothing there";
    for (int v = 0; v < kHeight; ++v)
        for (int u = 40; u < kWidth; ++u) image.row(v)[u] = 200;
    EXPECT_FALSE(fit_corner(image.view(), guess)) << "an edge is no corner";
    guess.pixel = {-20.0, 40.0};
    EXPECT_FALSE(fit_corner(image.view(), guess)) << "outside";
    for (const double far : {1e300, -1e300, 2147483647.0, -2147483648.0, std::nan("")}) {
        guess.pixel = {far, 40.0};
        EXPECT_FALSE(fit_corner(image.view(), guess)) << far;
        guess.pixel = {40.0, far};
        EXPECT_FALSE(fit_corner(image.view(), guess)) << far;
    }
    guess.pixel = {40.0, 40.0};
    guess.along_column_px = {8.0, 0.0};
    EXPECT_FALSE(fit_corner(image.view(), guess)) << "no directions";
}

}  // namespace
}  // namespace surefoot::calibration
