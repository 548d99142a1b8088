// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/reachability.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <string>
#include <utility>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::traversability {
namespace {

constexpr double kResolution_m = 0.025;

grid::GridGeometry geometry_of(const grid::Layer& map) {
    return {kResolution_m, map.width(), map.height(), {-1.0, 2.0}};
}

/// Returns the centre of a cell.
Eigen::Vector2d at(const grid::Layer& map, int ix, int iy) {
    return geometry_of(map).center_m({ix, iy});
}

grid::Layer reach(const TraversabilityConfig::Reach& config,
                  const grid::Layer& map,
                  const Eigen::Vector2d& body_m,
                  Stance* stance = nullptr) {
    grid::Layer out;
    const Stance found = Reachability(config).reach(geometry_of(map), map.view(), body_m, out);
    if (stance != nullptr) *stance = found;
    return out;
}

/// Sets a rectangle of cells to one height.
void put(grid::Layer& map, int ix0, int iy0, int nx, int ny, float height_m) {
    for (int iy = iy0; iy < iy0 + ny; ++iy)
        for (int ix = ix0; ix < ix0 + nx; ++ix) map.at(ix, iy) = height_m;
}

long tenths(float height_m) {
    return std::lround(static_cast<double>(height_m) * 1e4);
}

/// Stance by its definition: the heights that fill a quarter of the disc within 50 mm, or the
/// fullest such range.
std::vector<grid::Cell> plain_stance(const grid::Layer& map,
                                     const Eigen::Vector2d& body_m,
                                     double radius_m) {
    struct Found {
        double distance_m;
        grid::Cell cell;
        long height;
    };
    std::vector<Found> known;
    for (int iy = 0; iy < map.height(); ++iy)
        for (int ix = 0; ix < map.width(); ++ix)
            if (!std::isnan(map.at(ix, iy)))
                known.push_back(
                    {(at(map, ix, iy) - body_m).norm(), {ix, iy}, tenths(map.at(ix, iy))});
    std::sort(known.begin(), known.end(), [](const Found& a, const Found& b) {
        return a.distance_m < b.distance_m;
    });
    if (known.empty()) return {};
    const auto within = [&](const Found& f) { return f.distance_m <= radius_m; };
    if (std::count_if(known.begin(), known.end(), within) < 16)
        radius_m += known[std::min<std::size_t>(16, known.size()) - 1].distance_m;
    std::erase_if(known, [&](const Found& f) { return !within(f); });
    const auto on = [&](long low) {
        return std::count_if(known.begin(), known.end(), [&](const Found& f) {
            return f.height >= low && f.height <= low + 500;
        });
    };
    long most = 0;
    for (const Found& f : known) most = std::max<long>(most, on(f.height));
    if (4 * most >= static_cast<long>(known.size()))
        most = (static_cast<long>(known.size()) + 3) / 4;
    long lowest = std::numeric_limits<long>::max();
    for (const Found& f : known)
        if (on(f.height) >= most) lowest = std::min(lowest, f.height);
    std::vector<grid::Cell> cells;
    for (const Found& f : known)
        if (f.height >= lowest && f.height <= lowest + 500) cells.push_back(f.cell);
    return cells;
}

/// Minimax paths after Dijkstra with a priority queue; steps in 0.1 mm, -1 = not reachable.
Image<long> plain_reach(const grid::Layer& map,
                        const std::vector<grid::Cell>& stance,
                        long max_step) {
    Image<long> least(map.width(), map.height(), -1);
    using Entry = std::pair<long, std::pair<int, int>>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (const grid::Cell& cell : stance) queue.push({0, {cell.ix, cell.iy}});
    while (!queue.empty()) {
        const auto [step, cell] = queue.top();
        const auto [ix, iy] = cell;
        queue.pop();
        if (least.at(ix, iy) >= 0) continue;
        least.at(ix, iy) = step;
        for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
            if (!map.contains(ix + dx, iy + dy)) continue;
            const float other_m = map.at(ix + dx, iy + dy);
            if (std::isnan(other_m)) continue;
            const long rise = std::abs(tenths(other_m) - tenths(map.at(ix, iy)));
            if (rise <= max_step) queue.push({std::max(step, rise), {ix + dx, iy + dy}});
        }
    }
    return least;
}

/// Terraces of different heights with noise and holes: many ways, all of them over steps.
grid::Layer random_map(Rng& rng) {
    grid::Layer map(1 + static_cast<int>(rng.below(60)), 1 + static_cast<int>(rng.below(60)));
    const int tile = 1 + static_cast<int>(rng.below(9));
    const double rise_m = rng.uniform(0.0, 0.5);
    const double holes = rng.below(3) == 0 ? 0.0 : rng.uniform(0.0, 0.4);
    const double noise_m = rng.uniform(0.0, 0.02);
    grid::Layer level_m(map.width() / tile + 1, map.height() / tile + 1);
    for (std::size_t i = 0; i < level_m.size(); ++i)
        level_m.data()[i] = static_cast<float>(rng.uniform(-rise_m, rise_m));
    for (int iy = 0; iy < map.height(); ++iy)
        for (int ix = 0; ix < map.width(); ++ix)
            map.at(ix, iy) = rng.uniform() < holes ? kNanF
                                                   : level_m.at(ix / tile, iy / tile) +
                                                         static_cast<float>(noise_m * rng.normal());
    return map;
}

TEST(Reachability, IsTheMinimaxPathOfEveryCell) {
    constexpr std::uint64_t kSeed = 7;
    Rng rng(kSeed);
    Reachability kept({0.18, 0.1});  // reuses its memory for maps of all sizes
    long reached = 0, refused = 0;
    for (int round = 0; round < 400; ++round) {
        const grid::Layer map = random_map(rng);
        const grid::GridGeometry geometry = geometry_of(map);
        const Eigen::Vector2d body_m =
            geometry.origin_m + Eigen::Vector2d(rng.uniform(-0.2, 1.7), rng.uniform(-0.2, 1.7));
        grid::Layer out;
        const Stance stance = kept.reach(geometry, map.view(), body_m, out);
        const auto feet = plain_stance(map, body_m, 0.1);
        ASSERT_EQ(stance.cells, static_cast<int>(feet.size())) << "round " << round;
        const Image<long> expected = plain_reach(map, feet, 1800);
        for (int iy = 0; iy < map.height(); ++iy) {
            for (int ix = 0; ix < map.width(); ++ix) {
                const float step_m = out.at(ix, iy);
                const long step = std::isnan(step_m) ? -1 : tenths(step_m);
                ASSERT_EQ(step, expected.at(ix, iy))
                    << "round " << round << " cell " << ix << " " << iy;
                if (step >= 0) ++reached;
                if (step < 0 && !std::isnan(map.at(ix, iy))) ++refused;
            }
        }
    }
    EXPECT_GT(reached, 20'000);
    EXPECT_GT(refused, 20'000);
}

TEST(Reachability, ATableTopIsFlatButNotReachableAndStairsAreWhatTheyRise) {
    grid::Layer map(80, 60, 0.0F);
    put(map, 40, 10, 20, 20, 0.75F);  // table
    for (int i = 0; i < 3; ++i)
        put(map, 40 + 10 * i, 40, 10, 10, 0.17F * static_cast<float>(i + 1));
    const grid::Layer out = reach({}, map, at(map, 15, 20));
    EXPECT_EQ(out.at(70, 5), 0.0F);
    EXPECT_TRUE(std::isnan(out.at(50, 20)));
    EXPECT_FLOAT_EQ(out.at(45, 45), 0.17F);
    EXPECT_FLOAT_EQ(out.at(65, 45), 0.17F) << "three steps of 0.17 m, the largest is 0.17 m";
    const grid::Layer low = reach({0.02, 0.3}, map, at(map, 15, 20));
    EXPECT_TRUE(std::isnan(low.at(45, 45)));
    const grid::Layer high = reach({0.75, 0.3}, map, at(map, 15, 20));
    EXPECT_FLOAT_EQ(high.at(50, 20), 0.75F) << "a step of just the limit is taken";
}

TEST(Reachability, TheWayRoundCountsWhenItsStepsAreLower) {
    grid::Layer map(41, 41, 0.0F);
    put(map, 20, 0, 21, 41, 0.12F);
    for (int i = 0; i < 6; ++i) put(map, 14 + i, 38, 1, 3, 0.02F * static_cast<float>(i + 1));
    const grid::Layer out = reach({}, map, at(map, 8, 8));
    EXPECT_FLOAT_EQ(out.at(21, 2), 0.02F);
    put(map, 20, 38, 1, 3, kNanF);  // the upper end of the ramp is unknown
    const grid::Layer cut = reach({}, map, at(map, 8, 8));
    EXPECT_FLOAT_EQ(cut.at(21, 2), 0.12F);
}

TEST(Reachability, NoGapIsBridgedAndCornersDoNotTouch) {
    grid::Layer map(60, 40, 0.0F);
    put(map, 30, 0, 1, 40, kNanF);
    const grid::Layer out = reach({}, map, at(map, 10, 20));
    EXPECT_EQ(out.at(29, 20), 0.0F);
    EXPECT_TRUE(std::isnan(out.at(30, 20)));
    EXPECT_TRUE(std::isnan(out.at(31, 20)));
    grid::Layer corner(60, 40, kNanF);
    put(corner, 0, 0, 30, 20, 0.0F);
    put(corner, 30, 20, 30, 20, 0.0F);
    EXPECT_TRUE(std::isnan(reach({}, corner, at(corner, 10, 10)).at(30, 20)));
}

TEST(Reachability, StandsOnTheFloorUnderATableOnTheLandingBesideAPit) {
    Stance stance;
    grid::Layer table(80, 80, 0.1F);
    put(table, 43, 20, 30, 40, 0.85F);  // covers a part of the disc and all that is ahead
    const grid::Layer out = reach({}, table, at(table, 40, 40), &stance);
    EXPECT_NEAR(stance.lowest_m, 0.1, 1e-9);
    EXPECT_EQ(out.at(10, 10), 0.0F);
    EXPECT_TRUE(std::isnan(out.at(50, 40)));

    grid::Layer landing(80, 80, 2.0F);
    put(landing, 47, 0, 33, 80, 0.0F);  // the pit takes less than a quarter of the disc
    const grid::Layer upstairs = reach({}, landing, at(landing, 40, 40), &stance);
    EXPECT_NEAR(stance.lowest_m, 2.0, 1e-9);
    EXPECT_EQ(upstairs.at(0, 0), 0.0F);
    EXPECT_TRUE(std::isnan(upstairs.at(60, 40)));

    landing.at(38, 40) = -3.0F;  // a stray reflection
    EXPECT_EQ(reach({}, landing, at(landing, 40, 40)).at(0, 0), 0.0F);
}

TEST(Reachability, LooksFartherWhenTheGroundAtTheFeetIsNotInView) {
    grid::Layer map(120, 120, kNanF);
    put(map, 80, 40, 40, 40, 0.0F);
    put(map, 80, 55, 4, 10, 0.7F);  // the edge of a table comes first
    Stance stance;
    const grid::Layer out = reach({}, map, at(map, 60, 60), &stance);
    EXPECT_EQ(stance.lowest_m, 0.0);
    EXPECT_GT(stance.radius_m, 0.5 + 0.3 - 1e-9) << "20 cells to the nearest, and the radius";
    EXPECT_EQ(out.at(119, 79), 0.0F);
    EXPECT_TRUE(std::isnan(out.at(81, 60)));
}

TEST(Reachability, SaysNothingWithoutGroundOrPlace) {
    const grid::Layer unknown(20, 20, kNanF);
    Stance stance;
    const grid::Layer nothing = reach({}, unknown, at(unknown, 10, 10), &stance);
    EXPECT_EQ(stance.cells, 0);
    EXPECT_TRUE(std::all_of(
        nothing.data(), nothing.data() + nothing.size(), [](float s) { return std::isnan(s); }));
    const grid::Layer floor(20, 20, 0.0F);
    const grid::Layer lost = reach({}, floor, {std::nan(""), 0.0}, &stance);
    EXPECT_EQ(stance.cells, 0);
    EXPECT_TRUE(std::isnan(lost.at(3, 3)));
    grid::Layer broken(20, 20, 0.0F);
    broken.at(5, 5) = std::numeric_limits<float>::infinity();
    broken.at(6, 6) = 3e9F;
    const grid::Layer out = reach({1.0, 0.3}, broken, at(broken, 10, 10));
    EXPECT_TRUE(std::isnan(out.at(5, 5)) && std::isnan(out.at(6, 6)));
    EXPECT_EQ(out.at(0, 0), 0.0F);
    EXPECT_EQ(reach({}, grid::Layer(1, 1, 0.5F), {50.0, 50.0}).at(0, 0), 0.0F);
}

}  // namespace
}  // namespace surefoot::traversability
