// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/flights/flight_sides.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "surefoot/stairs/feature_finder.hpp"
#include "surefoot/stairs/terrain_testing.hpp"

namespace surefoot::stairs {
namespace {

using testing::Ground;
using testing::TestFlight;
using testing::TestMap;

constexpr double kHalfWidth_m = 0.6;
constexpr double kYaws_deg[] = {0.0, 31.0, 90.0, 200.0};
constexpr TestFlight kUp{.steps = 4, .riser_m = 0.18, .going_m = 0.31};

/// Returns the flight that has four steps, because an object beside it may also end in steps.
Flight flight_of(const Terrain& terrain) {
    FeatureFinder finder{StairsConfig{}};
    TerrainFeatures found;
    finder.find(terrain, found);
    for (const Flight& flight : found.flights)
        if (flight.steps == 4) return flight;
    ADD_FAILURE() << "not found";
    return {};
}

/// An object on the left, +y, of a flight along +x; it climbs with the flight.
Ground with_left(double above_m) {
    return [=](double x_m, double y_m) {
        const bool beside = y_m > kHalfWidth_m && x_m > 0.0 && x_m < 4 * 0.31 + 0.5;
        return beside ? 0.09 + x_m * 0.18 / 0.31 + above_m : kUp.at(x_m, y_m);
    };
}

TEST(FlightSides, a_flight_that_stands_alone_is_open_on_both_sides) {
    for (const double yaw_deg : kYaws_deg) {
        const TestMap map([](double x_m, double y_m) { return kUp.at(x_m, y_m); },
                          yaw_deg * kRadPerDeg,
                          {0.0, 0.0});
        const Flight flight = flight_of(map.terrain());
        EXPECT_EQ(flight.left.kind, SideKind::open) << yaw_deg;
        EXPECT_EQ(flight.right.kind, SideKind::open) << yaw_deg;
        EXPECT_EQ(flight.left.rail_m, 0.0);
    }
}

TEST(FlightSides, walls_and_level_ground_are_told_on_their_side) {
    for (const double yaw_deg : kYaws_deg) {
        SCOPED_TRACE(yaw_deg);
        const TestMap walled(with_left(1.6), yaw_deg * kRadPerDeg, {0.0, 0.0});
        const Flight left = flight_of(walled.terrain());
        EXPECT_EQ(left.left.kind, SideKind::wall);
        EXPECT_EQ(left.left.rail_m, 0.0) << "a wall is no rail";
        EXPECT_EQ(left.right.kind, SideKind::open);
        Flight beside_ramp = left;
        const TestMap ramp(with_left(0.0), yaw_deg * kRadPerDeg, {0.0, 0.0});
        FlightSides{}.find(ramp.terrain(), beside_ramp);
        EXPECT_EQ(beside_ramp.left.kind, SideKind::level);
        EXPECT_EQ(beside_ramp.right.kind, SideKind::open);
    }
}

TEST(FlightSides, a_well_has_walls_and_left_is_left_on_the_way_down) {
    const TestFlight down{.steps = 4, .riser_m = -0.18, .going_m = 0.31};
    // No ground to the right of the flight.
    const auto ground = [&](double x_m, double y_m) {
        return y_m < -kHalfWidth_m && x_m > 0.0 ? -2.0 : down.at(x_m, y_m);
    };
    const TestMap map(ground, 0.4, {0.0, 0.0});
    const Flight flight = flight_of(map.terrain());
    ASSERT_EQ(flight.kind, FlightKind::down);
    EXPECT_EQ(flight.left.kind, SideKind::wall);
    EXPECT_EQ(flight.right.kind, SideKind::open);
}

TEST(FlightSides, what_nobody_saw_is_unknown_and_what_lines_of_sight_passed_is_open) {
    TestMap map(with_left(1.0), 0.0, {0.0, 0.0});
    grid::Layer free_above_m(map.geometry.nx, map.geometry.ny, std::nanf(""));
    for (int iy = 0; iy < map.geometry.ny; ++iy) {
        for (int ix = 0; ix < map.geometry.nx; ++ix) {
            const double y_m = map.geometry.center_m({ix, iy}).y();
            if (std::abs(y_m) < kHalfWidth_m) continue;
            map.height_m.at(ix, iy) = std::nanf("");
            if (y_m < 0.0) free_above_m.at(ix, iy) = -0.3F;
        }
    }
    Terrain terrain = map.terrain();
    terrain.free_above_m = free_above_m.view();
    const Flight flight = flight_of(terrain);
    EXPECT_EQ(flight.left.kind, SideKind::unknown);
    EXPECT_EQ(flight.right.kind, SideKind::open);
}

/// Rails 50 mm wide on the left, at a height above the nosing line.
Ground with_rail(double above_m, double slope, double ends_m = 1.2) {
    return [=](double x_m, double y_m) {
        const bool rail =
            y_m > kHalfWidth_m && y_m < kHalfWidth_m + 0.05 && x_m > 0.0 && x_m < ends_m;
        return rail ? 0.18 + above_m + slope * x_m : kUp.at(x_m, y_m);
    };
}

TEST(FlightSides, a_rail_runs_along_the_noses) {
    constexpr double kClimb = 0.18 / 0.31;
    for (const double yaw_deg : kYaws_deg) {
        SCOPED_TRACE(yaw_deg);
        const TestMap map(with_rail(0.95, kClimb), yaw_deg * kRadPerDeg, {0.0, 0.0});
        const Flight flight = flight_of(map.terrain());
        EXPECT_NEAR(flight.left.rail_m, 0.95, 0.02);
        EXPECT_EQ(flight.left.kind, SideKind::open) << "there is no ground below it";
        EXPECT_EQ(flight.right.rail_m, 0.0);
    }
    const TestMap level(with_rail(1.05, 0.0), 0.3, {0.0, 0.0});
    EXPECT_EQ(flight_of(level.terrain()).left.rail_m, 0.0) << "something level";
    const TestMap post(with_rail(0.95, kClimb, 0.2), 0.3, {0.0, 0.0});
    EXPECT_EQ(flight_of(post.terrain()).left.rail_m, 0.0) << "beside one step of four";
    const TestMap low(with_rail(0.5, kClimb), 0.3, {0.0, 0.0});
    EXPECT_EQ(flight_of(low.terrain()).left.rail_m, 0.0) << "no rail is so low";
}

TEST(FlightSides, a_rail_may_hang_above_the_ground_beside) {
    TestMap map([](double x_m, double y_m) { return kUp.at(x_m, y_m); }, 0.0, {0.0, 0.0});
    grid::Layer clearance_m(map.geometry.nx, map.geometry.ny, std::nanf(""));
    for (int iy = 0; iy < map.geometry.ny; ++iy) {
        for (int ix = 0; ix < map.geometry.nx; ++ix) {
            const Eigen::Vector2d p_m = map.geometry.center_m({ix, iy});
            if (std::abs(p_m.y() + kHalfWidth_m + 0.02) > 0.03 || p_m.x() < 0.0 || p_m.x() > 1.2)
                continue;
            const double rail_m = 0.18 + 0.9 + p_m.x() * 0.18 / 0.31;
            clearance_m.at(ix, iy) =
                static_cast<float>(rail_m - static_cast<double>(map.height_m.at(ix, iy)));
        }
    }
    Terrain terrain = map.terrain();
    terrain.clearance_m = clearance_m.view();
    const Flight flight = flight_of(terrain);
    EXPECT_NEAR(flight.right.rail_m, 0.9, 0.02);
    EXPECT_EQ(flight.left.rail_m, 0.0);
}

}  // namespace
}  // namespace surefoot::stairs
