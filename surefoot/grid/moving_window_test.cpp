// SPDX-License-Identifier: Apache-2.0
#include "surefoot/grid/moving_window.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/grid/sliding_layer.hpp"

namespace surefoot::grid {
namespace {

constexpr int kUnknown = -1;

using Lattice = std::map<std::pair<std::int64_t, std::int64_t>, int>;

/// Removes the cells outside the window, as the window must do.
void crop(Lattice& truth, const MovingWindow& window) {
    std::erase_if(truth, [&](const auto& entry) {
        const std::int64_t ix = entry.first.first - window.first_ix();
        const std::int64_t iy = entry.first.second - window.first_iy();
        return ix < 0 || iy < 0 || ix >= window.geometry().nx || iy >= window.geometry().ny;
    });
}

testing::AssertionResult same(const Lattice& truth,
                              const MovingWindow& window,
                              const SlidingLayer<int>& layer) {
    for (int iy = 0; iy < layer.height(); ++iy) {
        for (int ix = 0; ix < layer.width(); ++ix) {
            const auto found = truth.find({window.first_ix() + ix, window.first_iy() + iy});
            const int expected = found == truth.end() ? kUnknown : found->second;
            if (layer.at(ix, iy) != expected) {
                return testing::AssertionFailure()
                       << "cell (" << ix << ", " << iy << ") holds " << layer.at(ix, iy)
                       << ", the map by lattice index " << expected;
            }
        }
    }
    return testing::AssertionSuccess();
}

TEST(MovingWindow, StartsCentredOnTheOriginWithTheRoundedLength) {
    const MovingWindow window(6.0, 0.025);
    EXPECT_EQ(window.geometry().nx, 240);
    EXPECT_EQ(window.geometry().ny, 240);
    EXPECT_DOUBLE_EQ(window.geometry().origin_m.x(), -3.0);
    EXPECT_EQ(window.geometry().cell_at(0.001, -0.001), (Cell{120, 119}));
}

TEST(MovingWindow, MovesByWholeCellsHalvesAwayFromZero) {
    MovingWindow window(2.0, 0.0625);  // a power of two, so that half cells are exact
    EXPECT_EQ(window.center_on(0.03124, -0.03124), (Shift{0, 0}));
    EXPECT_EQ(window.center_on(0.03125, -0.03125), (Shift{1, -1}));
    EXPECT_DOUBLE_EQ(window.geometry().origin_m.x(), -1.0 + 0.0625);
    EXPECT_EQ(window.center_on(0.0, 0.0), (Shift{-1, 1}));
}

TEST(MovingWindow, StaysForAPointThatIsNotFinite) {
    MovingWindow window(2.0, 0.05);
    EXPECT_TRUE(window.center_on(kNan, 0.0).is_zero());
    EXPECT_TRUE(window.center_on(0.0, std::numeric_limits<double>::infinity()).is_zero());
    EXPECT_EQ(window.first_ix(), -20);
}

TEST(MovingWindow, OneCellWindowForgetsEverythingWhenItMoves) {
    MovingWindow window(0.01, 0.05);
    SlidingLayer<int> layer(window.geometry().nx, window.geometry().ny, 7);
    ASSERT_EQ(layer.size(), 1U);
    layer.shift(window.center_on(-10.0, 0.0), kUnknown);
    EXPECT_EQ(layer.at(0, 0), kUnknown);
}

TEST(MovingWindow, ContentsFollowARandomWalkLikeAMapByLatticeIndex) {
    constexpr std::uint64_t kSeed = 7;
    for (const double length_m : {0.05, 0.4, 0.55, 1.0}) {
        Rng rng(mix_seed(kSeed, static_cast<std::uint64_t>(length_m * 1000.0)));
        MovingWindow window(length_m, 0.05);
        const int n = window.geometry().nx;
        SlidingLayer<int> layer(n, n, kUnknown);
        Lattice truth;
        double x_m = 0.0;
        double y_m = 0.0;
        for (int step = 0; step < 400; ++step) {
            const double reach_m = step % 10 == 0 ? 1.5 * length_m : 0.12;
            x_m += rng.uniform(-reach_m, reach_m);
            y_m += rng.uniform(-reach_m, reach_m);
            const Shift shift = window.center_on(x_m, y_m);
            layer.shift(shift, kUnknown);
            crop(truth, window);
            const Eigen::Vector2d centre_m =
                window.geometry().origin_m + Eigen::Vector2d::Constant(0.025 * n);
            // Half a cell plus the rounding of a few additions.
            ASSERT_LE((centre_m - Eigen::Vector2d(x_m, y_m)).cwiseAbs().maxCoeff(), 0.025 + 1e-9);
            ASSERT_TRUE(same(truth, window, layer)) << "length " << length_m << " step " << step
                                                    << " shift " << shift.dx << ", " << shift.dy;
            for (int k = 0; k < 5; ++k) {
                const Cell cell{static_cast<int>(rng.below(static_cast<std::uint64_t>(n))),
                                static_cast<int>(rng.below(static_cast<std::uint64_t>(n)))};
                layer.at(cell.ix, cell.iy) = step;
                const Eigen::Vector2d p_m = window.geometry().center_m(cell);
                truth[{static_cast<std::int64_t>(std::floor(p_m.x() / 0.05)),
                       static_cast<std::int64_t>(std::floor(p_m.y() / 0.05))}] = step;
            }
        }
    }
}

TEST(SlidingLayer, SlidesAsItShiftsButForTheCellsThatCameIntoView) {
    constexpr int kSide = 7;
    constexpr std::uint8_t kOutside = 255;
    Rng rng(4);
    SlidingLayer<std::uint8_t> shifted(kSide, kSide, kOutside);
    SlidingLayer<std::uint8_t> slid(kSide, kSide, kOutside);
    for (int step = 0; step < 500; ++step) {
        const Shift shift{static_cast<int>(rng.below(11)) - 5, static_cast<int>(rng.below(11)) - 5};
        shifted.shift(shift, kOutside);
        slid.slide(shift);
        for (int iy = 0; iy < kSide; ++iy) {
            for (int ix = 0; ix < kSide; ++ix) {
                const bool stayed = ix + shift.dx >= 0 && ix + shift.dx < kSide &&
                                    iy + shift.dy >= 0 && iy + shift.dy < kSide;
                if (!stayed) {
                    ASSERT_EQ(shifted.at(ix, iy), kOutside) << "step " << step;
                    slid.at(ix, iy) = kOutside;
                }
                ASSERT_EQ(slid.at(ix, iy), shifted.at(ix, iy)) << "step " << step;
            }
        }
        const auto value = static_cast<std::uint8_t>(step % 200);
        const int ix = static_cast<int>(rng.below(kSide));
        const int iy = static_cast<int>(rng.below(kSide));
        shifted.at(ix, iy) = value;
        slid.at(ix, iy) = value;
    }
}

TEST(MovingWindow, OriginOfAPlaceDoesNotDependOnThePath) {
    MovingWindow direct(6.0, 0.025);
    MovingWindow wandering(6.0, 0.025);
    for (int step = 1; step <= 1000; ++step) wandering.center_on(0.037 * step, -0.021 * step);
    direct.center_on(37.0, -21.0);
    wandering.center_on(37.0, -21.0);
    EXPECT_EQ(direct.geometry().origin_m, wandering.geometry().origin_m);
}

}  // namespace
}  // namespace surefoot::grid
