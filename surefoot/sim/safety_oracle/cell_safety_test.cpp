// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/safety_oracle/cell_safety.hpp"

#include <gtest/gtest.h>

#include "surefoot/sim/safety_oracle/safety_testing.hpp"

namespace surefoot::sim {
namespace {

using namespace testing;
using Eigen::Vector2d;

const Lattice kLattice{{-0.5, -0.1}, 60, 8, 0.025};  // x to 1.0, y to 0.1

CellSafety at(const Image<CellSafety>& cells, double x_m, double y_m) {
    const Vector2d cell = (Vector2d(x_m, y_m) - kLattice.origin_m) / kLattice.resolution_m;
    return cells.at(static_cast<int>(cell.x()), static_cast<int>(cell.y()));
}

Image<CellSafety> ask(const World& world, double yaw_rad = 0.0) {
    Serial serial;
    CellQuestion question;
    question.yaw_rad = yaw_rad;
    return cell_safety(world.scene, testing::rex(), kLattice, question, serial);
}

int count(const Image<CellSafety>& cells, Danger danger) {
    int n = 0;
    for (int iy = 0; iy < cells.height(); ++iy) {
        for (int ix = 0; ix < cells.width(); ++ix)
            n += !cells.at(ix, iy).safe && cells.at(ix, iy).danger == danger ? 1 : 0;
    }
    return n;
}

TEST(CellSafetyTest, AFlatFloorIsSafeEverywhere) {
    const auto cells = ask(World().floor(), 0.5);
    for (int iy = 0; iy < cells.height(); ++iy) {
        for (int ix = 0; ix < cells.width(); ++ix) EXPECT_TRUE(cells.at(ix, iy).safe);
    }
}

/// Required distance of the foot's centre before the edge: half its length (0.183 m) and the band
/// (0.1 m), or half its width (0.095 m) and the band if the foot stands across.
TEST(CellSafetyTest, AnEdgeIsKeptAtHalfAFootAndTheBand) {
    World world;
    world.floor(-0.17).box({-3.0, 0.605}, {-3.0, 3.0}, {-0.17, 0.0});
    for (const double yaw : {0.0, std::numbers::pi / 2}) {
        const double half_m = yaw == 0.0 ? 0.183 : 0.095;
        const auto cells = ask(world, yaw);
        for (int ix = 0; ix < kLattice.nx; ++ix) {
            const double to_edge_m = 0.605 - kLattice.center_m(ix, 0).x();
            const auto near = [&](double limit_m) {
                return std::abs(to_edge_m - limit_m) <= kSpacing_m;
            };
            if (near(half_m) || near(half_m + 0.1) || near(0.0) || near(-half_m)) continue;
            const CellSafety& cell = cells.at(ix, 4);
            EXPECT_EQ(cell.safe, std::abs(to_edge_m) > half_m + (to_edge_m > 0.0 ? 0.1 : 0.0))
                << to_edge_m << " yaw " << yaw << " " << to_string(cell.danger);
            if (cell.safe) continue;
            const Danger expected = to_edge_m < 0.0      ? Danger::step_up
                                    : to_edge_m < half_m ? Danger::drop_off
                                                         : Danger::edge_too_near;
            if (to_edge_m < 0.0) continue;  // below the platform: tested with the kerb
            EXPECT_EQ(cell.danger, expected) << to_edge_m << " " << to_string(cell.danger);
        }
    }
}

TEST(CellSafetyTest, UnderATableThereIsNoRoomAndItsTopIsNoGround) {
    const auto cells = ask(World().floor().box({0.3, 0.9}, {-0.3, 0.3}, {0.69, 0.72}));
    EXPECT_EQ(at(cells, 0.6, 0.0).danger, Danger::body_hits);
    EXPECT_TRUE(at(cells, 0.0, 0.0).safe);
    const auto beams = ask(World().floor().box({0.3, 0.9}, {-3.0, 3.0}, {1.9, 2.3}));
    EXPECT_EQ(at(beams, 0.6, 0.0).danger, Danger::overhang_too_low);
    const auto lintel = ask(World().floor().box({0.3, 0.9}, {-3.0, 3.0}, {2.06, 2.3}));
    EXPECT_TRUE(at(lintel, 0.6, 0.0).safe);
}

TEST(CellSafetyTest, AnObstacleOfAnyHeightIsNotStoodOn) {
    const auto pillar = ask(World().floor().box({0.4, 0.6}, {-0.1, 0.1}, {0.0, 1.0}));
    EXPECT_EQ(at(pillar, 0.5, 0.0).danger, Danger::disconnected);
    EXPECT_EQ(at(pillar, 0.3, 0.0).danger, Danger::step_up);
    EXPECT_TRUE(at(pillar, 0.15, 0.0).safe);
    const auto kerb = ask(World().floor().box({0.4, 2.0}, {-3.0, 3.0}, {0.0, 0.10}));
    EXPECT_EQ(at(kerb, 0.3, 0.0).danger, Danger::step_up);
    EXPECT_EQ(at(kerb, 0.5, 0.0).danger, Danger::drop_off);
    EXPECT_TRUE(at(kerb, 0.75, 0.0).safe);
}

TEST(CellSafetyTest, RampsAreSafeUpToTheTiltLimit) {
    for (const double slope_deg : {5.0, 7.0}) {
        const double slope = std::tan(slope_deg * std::numbers::pi / 180.0);
        World world;
        world.slab({-3.0, 3.0}, {-3.0, 3.0}, -2.0, {slope, 0.0});
        const auto cells = ask(world, 0.3);
        EXPECT_EQ(count(cells, Danger::tilt), slope_deg < 6.0 ? 0 : kLattice.nx * kLattice.ny);
        EXPECT_EQ(at(cells, 0.5, 0.05).safe, slope_deg < 6.0);
    }
}

TEST(CellSafetyTest, VoidsAndUnreachedFloorsAreNotSafe) {
    EXPECT_EQ(count(ask(World()), Danger::no_ground), kLattice.nx * kLattice.ny);
    const Pit trench{{{0.4, -3.0}, {0.5, 3.0}}, 0.5};
    const auto cells = ask(World().floor(0.0, {trench}));
    EXPECT_EQ(at(cells, 0.9, 0.0).danger, Danger::disconnected);
    EXPECT_TRUE(at(cells, 0.0, 0.0).safe);
    World half;
    half.box({-3.0, 0.45}, {-3.0, 3.0}, {-0.5, 0.0});
    EXPECT_EQ(at(ask(half), 0.4, 0.0).danger, Danger::no_ground);
    EXPECT_EQ(at(ask(half), 0.2, 0.0).danger, Danger::edge_too_near);
    Serial serial;
    EXPECT_TRUE(cell_safety(half.scene, testing::rex(), Lattice{}, {}, serial).empty());
}

TEST(CellSafetyTest, OpenRisersCarryTheFootAndDemoStairsHaveTooShortTreads) {
    // Two deep floating treads: the upper of two surfaces counts where it is joined to the start.
    World world;
    world.floor().box({0.1, 2.0}, {-3.0, 3.0}, {0.14, 0.18});
    const auto cells = ask(world);
    EXPECT_TRUE(at(cells, 0.6, 0.0).safe) << to_string(at(cells, 0.6, 0.0).danger);
    World flight;
    flight.floor()
        .box({0.3, 2.0}, {-3.0, 3.0}, {0.0, 0.18})
        .box({0.61, 2.0}, {-3.0, 3.0}, {0.0, 0.36});
    const auto treads = ask(flight);
    for (double x_m = 0.31; x_m < 0.60; x_m += 0.025) EXPECT_FALSE(at(treads, x_m, 0.0).safe);
}

}  // namespace
}  // namespace surefoot::sim
