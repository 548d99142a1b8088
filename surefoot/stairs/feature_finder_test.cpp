// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/feature_finder.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "surefoot/core/unknown.hpp"
#include "surefoot/stairs/terrain_testing.hpp"

namespace surefoot::stairs {
namespace {

using testing::Ground;
using testing::TestFlight;
using testing::TestMap;

/// Position error of an edge along the rows: up to half a cell from the cell centres. An edge
/// across the rows is far more accurate.
constexpr double kAcross_m = 0.0131;
const double kYaws_deg[] = {0.0, 7.0, 31.0, 45.0, 90.0, 133.0, 200.0, 270.0};

TerrainFeatures find(const Terrain& terrain) {
    FeatureFinder finder{StairsConfig{}};
    TerrainFeatures found;
    finder.find(terrain, found);
    return found;
}

Ground ground_of(const TestFlight& flight) {
    return [flight](double x_m, double y_m) { return flight.at(x_m, y_m); };
}

/// The stance is the position of the camera on the floor.
TerrainFeatures seen_from(TestMap& map, double x_m, double height_m = 1.0) {
    map.hide_from({x_m, 0.0, height_m});
    return find(map.terrain({x_m, 0.0}));
}

TEST(FeatureFinder, flights_up_have_all_their_steps_at_any_yaw) {
    for (const double yaw_deg : kYaws_deg) {
        for (const int steps : {1, 2, 3, 5}) {
            const TestFlight flight{.steps = steps, .riser_m = 0.18, .going_m = 0.31};
            const TestMap map(ground_of(flight), yaw_deg * kRadPerDeg, {0.013, -0.007});
            const TerrainFeatures found = find(map.terrain());
            SCOPED_TRACE(::testing::Message() << yaw_deg << " deg, " << steps << " steps");
            ASSERT_EQ(found.flights.size(), 1U);
            const Flight& f = found.flights.front();
            EXPECT_EQ(f.kind, FlightKind::up);
            EXPECT_EQ(f.steps, steps);
            EXPECT_NEAR(f.riser_m, flight.riser_m, 1e-4);
            if (steps > 1) {
                EXPECT_NEAR(f.going_m, flight.going_m, 2.0 * kAcross_m / (steps - 1));
            }
            EXPECT_NEAR(
                std::remainder(f.pose.yaw_rad - yaw_deg * kRadPerDeg, 2.0 * std::numbers::pi),
                0.0,
                1.0 * kRadPerDeg);
            EXPECT_NEAR(map.to_world(f.pose.p_m.head<2>()).x(), 0.0, kAcross_m);
            EXPECT_NEAR(f.pose.p_m.z(), 0.0, 1e-4);
            EXPECT_NEAR(f.width_m, flight.width_m, 0.06);
            EXPECT_TRUE(found.drops.empty());
        }
    }
}

TEST(FeatureFinder, flights_down_are_read_from_the_strips_of_their_treads_that_are_in_sight) {
    for (const double yaw_deg : kYaws_deg) {
        const TestFlight flight{.steps = 4, .riser_m = -0.17, .going_m = 0.29};
        TestMap map(ground_of(flight), yaw_deg * kRadPerDeg, {-0.004, 0.011});
        const TerrainFeatures found = seen_from(map, -0.7);
        SCOPED_TRACE(::testing::Message() << yaw_deg << " deg");
        ASSERT_EQ(found.flights.size(), 1U);
        const Flight& f = found.flights.front();
        EXPECT_EQ(f.kind, FlightKind::down);
        EXPECT_EQ(f.steps, 4);
        EXPECT_NEAR(f.riser_m, 0.17, 1e-3);
        EXPECT_NEAR(f.going_m, 0.29, 0.005);
        EXPECT_NEAR(map.to_world(f.pose.p_m.head<2>()).x(), 0.0, kAcross_m);
        // The first edge is also a drop of one step.
        bool drop = false;
        for (const LineFeature& d : found.drops)
            drop = drop || (std::abs(map.to_world(d.pose.p_m.head<2>()).x()) <= kAcross_m &&
                            std::abs(d.height_m + 0.17) <= 1e-3);
        EXPECT_TRUE(drop);
    }
}

TEST(FeatureFinder, noise_of_3_mm_changes_a_riser_by_less_than_1_mm) {
    const TestFlight flight{.steps = 4, .riser_m = 0.15, .going_m = 0.28};
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        TestMap map(ground_of(flight), 0.3 * static_cast<double>(seed), {0.0, 0.0});
        map.add_noise(0.003, seed);
        const TerrainFeatures found = find(map.terrain());
        ASSERT_EQ(found.flights.size(), 1U) << "seed " << seed;
        EXPECT_EQ(found.flights[0].steps, 4) << "seed " << seed;
        EXPECT_NEAR(found.flights[0].riser_m, 0.15, 1e-3) << "seed " << seed;
        EXPECT_NEAR(found.flights[0].going_m, 0.28, 0.006) << "seed " << seed;
        // Levels share errors that no cell states; a map without variances has none.
        EXPECT_GE(found.flights[0].riser_sigma_m, 0.001) << "seed " << seed;
    }
    const TestMap exact(ground_of(flight), 0.3, {0.0, 0.0});
    EXPECT_LT(find(exact.terrain()).flights.at(0).riser_sigma_m, 0.0005);
}

TEST(FeatureFinder, a_first_step_almost_level_with_the_floor_is_a_step) {
    const TestFlight flight{.steps = 4, .riser_m = 0.18, .going_m = 0.31, .first_riser_m = 0.05};
    const TestMap map(ground_of(flight), 0.5, {0.0, 0.0});
    const TerrainFeatures found = find(map.terrain());
    ASSERT_EQ(found.flights.size(), 1U);
    EXPECT_EQ(found.flights[0].steps, 4);
    EXPECT_NEAR(found.flights[0].riser_m, 0.18, 1e-3);
    EXPECT_NEAR(map.to_world(found.flights[0].pose.p_m.head<2>()).x(), 0.0, kAcross_m);
}

TEST(FeatureFinder, who_stands_on_a_stair_has_a_flight_up_and_one_down) {
    const TestFlight flight{.steps = 5, .riser_m = 0.18, .going_m = 0.31};
    const TestMap map(ground_of(flight), 0.0, {0.0, 0.0});
    const TerrainFeatures found = find(map.terrain({0.45, 0.0}));
    ASSERT_EQ(found.flights.size(), 2U);
    int up = 0;
    int down = 0;
    for (const Flight& f : found.flights) (f.kind == FlightKind::up ? up : down) += f.steps;
    EXPECT_EQ(up, 3);
    EXPECT_EQ(down, 2);
}

TEST(FeatureFinder, a_kerb_down_is_a_drop_and_a_kerb_where_the_ground_above_it_ends) {
    for (const double height_m : {0.075, 0.1, 0.15}) {
        for (const double yaw_deg : kYaws_deg) {
            TestMap map([&](double x_m, double) { return x_m < 0.3 ? 0.0 : -height_m; },
                        yaw_deg * kRadPerDeg,
                        {0.006, 0.001});
            map.add_noise(0.003, 5);
            const TerrainFeatures found = seen_from(map, -1.0);
            SCOPED_TRACE(::testing::Message() << yaw_deg << " deg, " << height_m << " m");
            ASSERT_EQ(found.drops.size(), 1U);
            EXPECT_NEAR(found.drops[0].height_m, -height_m, 0.003);
            const Eigen::Vector2d p_m = map.to_world(found.drops[0].pose.p_m.head<2>());
            EXPECT_NEAR(p_m.x(), 0.3, kAcross_m);
            EXPECT_GT(found.drops[0].length_m, 3.0);
            EXPECT_TRUE(found.drops[0].bottom_seen);
            ASSERT_EQ(found.kerbs.size(), 1U);
            EXPECT_EQ(found.kerbs[0].height_m, found.drops[0].height_m);
        }
    }
}

TEST(FeatureFinder, a_kerb_up_is_a_kerb_and_no_drop) {
    const TestMap map([](double x_m, double) { return x_m < 0.3 ? 0.0 : 0.12; }, 0.2, {0.0, 0.0});
    const TerrainFeatures found = find(map.terrain());
    EXPECT_TRUE(found.drops.empty());
    ASSERT_EQ(found.kerbs.size(), 1U);
    EXPECT_NEAR(found.kerbs[0].height_m, 0.12, 1e-4);
}

TEST(FeatureFinder, what_cannot_be_walked_to_is_no_drop) {
    // A table: its far rim is 0.7 m above the floor, but nobody can stand on it.
    const TestMap map(
        [](double x_m, double y_m) {
            return x_m > 0.2 && x_m < 1.0 && std::abs(y_m) < 0.6 ? 0.7 : 0.0;
        },
        0.0,
        {0.0, 0.0});
    const TerrainFeatures found = find(map.terrain());
    EXPECT_FALSE(found.edges.empty());
    EXPECT_TRUE(found.drops.empty());
    EXPECT_TRUE(found.flights.empty());
    EXPECT_TRUE(found.kerbs.empty());
}

TEST(FeatureFinder, a_bar_that_is_narrower_than_a_foot_is_no_ground_that_ends_in_a_drop) {
    // The bar stands on a slope of 45 deg. The machine can walk to the slope before the bar, but
    // not to the top of the bar.
    for (const double width_m : {0.05, 0.1}) {
        const TestMap map(
            [&](double x_m, double) {
                return std::abs(x_m - 0.35) < 0.5 * width_m ? 1.25 : std::clamp(x_m, 0.0, 0.9);
            },
            0.0,
            {0.0, 0.0});
        const TerrainFeatures found = find(map.terrain());
        EXPECT_FALSE(found.edges.empty()) << width_m;
        EXPECT_TRUE(found.drops.empty()) << width_m;
    }
    // Ground that falls behind a low sill is a drop.
    const TestMap sill(
        [](double x_m, double) { return x_m < 0.5    ? 0.0
                                        : x_m < 0.55 ? 0.06
                                                     : -0.4; },
        0.0,
        {0.0, 0.0});
    EXPECT_FALSE(find(sill.terrain()).drops.empty());
}

TEST(FeatureFinder, the_rim_of_a_hole_is_a_drop_on_all_sides) {
    const TestMap map(
        [](double x_m, double y_m) {
            return x_m > 0.2 && x_m < 1.4 && std::abs(y_m) < 0.7 ? -0.4 : 0.0;
        },
        0.4,
        {0.0, 0.0});
    const TerrainFeatures found = find(map.terrain());
    double rim_m = 0.0;
    for (const LineFeature& d : found.drops) rim_m += d.length_m;
    EXPECT_NEAR(rim_m, 2.0 * (1.2 + 1.4), 0.3);
    EXPECT_TRUE(found.flights.empty());
}

TEST(FeatureFinder, slopes_are_no_edges) {
    for (const double slope : {0.02, 0.083, 0.125, 0.2, 0.3}) {
        const TestMap map([&](double x_m, double) { return slope * x_m; }, 0.3, {0.0, 0.0});
        const TerrainFeatures found = find(map.terrain());
        EXPECT_TRUE(found.edges.empty()) << slope;
    }
}

/// A spiral: treads are sectors of `turn_deg` between two radii about (0, 0).
struct Spiral {
    int steps = 9;
    double riser_m = 0.17;
    double turn_deg = 25.0;
    double inner_m = 0.35;
    double outer_m = 1.35;
    [[nodiscard]] double at(double x_m, double y_m) const {
        const double radius_m = std::hypot(x_m, y_m);
        if (radius_m < inner_m || radius_m > outer_m) return 0.0;
        const double angle_deg = std::atan2(y_m, x_m) / kRadPerDeg;  // the first edge lies along +x
        const double step = std::floor(angle_deg / turn_deg);
        return step < 0.0 || step >= steps ? 0.0 : (step + 1.0) * riser_m;
    }
};

// Goings are measured at the middle of the edges, the walking line.
TEST(FeatureFinder, the_steps_of_a_spiral_turn) {
    const Spiral spiral{.steps = 6};
    for (const double yaw_deg : {0.0, 40.0}) {
        const TestMap map([&](double x_m, double y_m) { return spiral.at(x_m, y_m); },
                          yaw_deg * kRadPerDeg,
                          Eigen::Vector2d::Zero());
        const TerrainFeatures found = find(map.terrain({0.85, -1.0}));
        ASSERT_FALSE(found.flights.empty());
        const Flight& f = found.flights.front();
        EXPECT_EQ(f.steps, 6) << yaw_deg;
        EXPECT_NEAR(f.riser_m, spiral.riser_m, 1e-3);
        EXPECT_NEAR(std::abs(f.turn_rad), 5.0 * spiral.turn_deg * kRadPerDeg, 5.0 * kRadPerDeg);
        EXPECT_NEAR(f.going_m, 0.85 * spiral.turn_deg * kRadPerDeg, 0.03);
    }
}

TEST(FeatureFinder, flights_about_a_landing_are_two_that_meet_there) {
    // Three steps along +x to a landing of 1.2 m at 0.51 m, from there three along +y.
    const auto ground = [](double x_m, double y_m) {
        if (std::abs(y_m) <= 0.6 && x_m >= 0.0)
            return x_m < 0.9 ? 0.17 * (1.0 + std::floor(x_m / 0.3)) : x_m < 2.1 ? 0.51 : 0.0;
        if (x_m >= 0.9 && x_m < 2.1 && y_m > 0.6 && y_m < 1.5 + 0.6)
            return 0.51 + 0.17 * (1.0 + std::min(2.0, std::floor((y_m - 0.6) / 0.3)));
        return 0.0;
    };
    const TestMap map(ground, 0.2, Eigen::Vector2d::Zero());
    const TerrainFeatures found = find(map.terrain());
    std::vector<Flight> up;
    for (const Flight& flight : found.flights)
        if (flight.kind == FlightKind::up && flight.steps > 1) up.push_back(flight);
    ASSERT_EQ(up.size(), 2U);
    EXPECT_EQ(up[0].steps, 3);
    EXPECT_EQ(up[1].steps, 3);
    EXPECT_NEAR(up[0].landing_m, 1.5, 0.05);
    EXPECT_NEAR(up[1].pose.p_m.z(), 0.51, 0.005);
    EXPECT_NEAR(
        std::abs(std::remainder(up[1].pose.yaw_rad - up[0].pose.yaw_rad, 2.0 * std::numbers::pi)),
        90.0 * kRadPerDeg,
        2.0 * kRadPerDeg);
}

TEST(FeatureFinder, two_flights_side_by_side_are_two) {
    const TestFlight left{.steps = 3, .riser_m = 0.18, .going_m = 0.31, .width_m = 1.0};
    const TestFlight right{.steps = 3, .riser_m = 0.15, .going_m = 0.28, .width_m = 1.0};
    const TestMap map(
        [&](double x_m, double y_m) {
            return y_m > 0.0 ? left.at(x_m, y_m - 0.8) : right.at(x_m - 0.1, y_m + 0.8);
        },
        0.0,
        {0.0, 0.0});
    const TerrainFeatures found = find(map.terrain());
    ASSERT_EQ(found.flights.size(), 2U);
    const Flight& first = found.flights[0].pose.p_m.y() > 0.0 ? found.flights[0] : found.flights[1];
    const Flight& second =
        found.flights[0].pose.p_m.y() > 0.0 ? found.flights[1] : found.flights[0];
    EXPECT_NEAR(first.riser_m, 0.18, 1e-3);
    EXPECT_NEAR(second.riser_m, 0.15, 1e-3);
    EXPECT_EQ(first.steps, 3);
    EXPECT_EQ(second.steps, 3);
}

TEST(FeatureFinder, a_flight_that_the_map_cuts_off_says_so) {
    const TestFlight flight{.steps = 20, .riser_m = 0.17, .going_m = 0.28};
    const TestMap map(ground_of(flight), 0.0, {1.0, 0.0});  // 1.5 m of the flight lie in the map
    const TerrainFeatures found = find(map.terrain());
    ASSERT_EQ(found.flights.size(), 1U);
    EXPECT_EQ(found.flights[0].steps, 6);
    EXPECT_TRUE(found.flights[0].cut);
}

TEST(FeatureFinder, cells_may_be_small_or_large) {
    const TestFlight flight{.steps = 3, .riser_m = 0.18, .going_m = 0.31};
    for (const double resolution_m : {0.01, 0.02, 0.05}) {
        const TestMap map(ground_of(flight), 0.35, {0.0, 0.0}, resolution_m, 3.0);
        const TerrainFeatures found = find(map.terrain());
        ASSERT_EQ(found.flights.size(), 1U) << resolution_m;
        EXPECT_EQ(found.flights[0].steps, 3) << resolution_m;
        EXPECT_NEAR(found.flights[0].riser_m, 0.18, 1e-3) << resolution_m;
        EXPECT_NEAR(found.flights[0].going_m, 0.31, 0.25 * resolution_m) << resolution_m;
    }
}

TEST(FeatureFinder, heights_of_8_bits_and_holes_are_no_trouble) {
    const TestFlight flight{.steps = 4, .riser_m = 0.18, .going_m = 0.31};
    TestMap map(ground_of(flight), 0.9, {0.0, 0.0});
    Rng rng(3);
    for (std::size_t i = 0; i < map.height_m.size(); ++i) {
        float& z_m = map.height_m.data()[i];
        z_m = std::round(z_m / 0.0049F) * 0.0049F;
        if (rng.uniform() < 0.05) z_m = kNanF;
    }
    const TerrainFeatures found = find(map.terrain());
    ASSERT_EQ(found.flights.size(), 1U);
    EXPECT_EQ(found.flights[0].steps, 4);
    EXPECT_NEAR(found.flights[0].riser_m, 0.18, 0.002);
}

TEST(FeatureFinder, nothing_sensible_gives_nothing) {
    const auto expect_nothing = [](const Terrain& terrain, const char* what) {
        const TerrainFeatures found = find(terrain);
        EXPECT_TRUE(found.flights.empty()) << what;
        EXPECT_TRUE(found.drops.empty()) << what;
        EXPECT_TRUE(found.kerbs.empty()) << what;
    };
    const TestMap flat([](double, double) { return 0.4; }, 0.0, {0.0, 0.0});
    expect_nothing(flat.terrain(), "flat");
    TestMap unknown = flat;
    unknown.height_m.fill(kNanF);
    expect_nothing(unknown.terrain(), "unknown");
    TestMap broken = flat;
    broken.height_m.fill(std::numeric_limits<float>::infinity());
    expect_nothing(broken.terrain(), "infinite");
    TestMap noise = flat;
    noise.add_noise(0.1, 7);
    expect_nothing(noise.terrain(), "noise");
    noise.var_m2.fill(0.0F);  // the map states a variance of zero
    EXPECT_TRUE(find(noise.terrain()).flights.empty());
    TestMap nowhere = flat;
    Terrain terrain = nowhere.terrain();
    terrain.stance_m.setConstant(std::numeric_limits<double>::quiet_NaN());
    expect_nothing(terrain, "no stance");

    grid::Layer cell(1, 1, 0.0F);
    Terrain one;
    one.geometry = {0.025, 1, 1, {0.0, 0.0}};
    one.height_m = cell.view();
    expect_nothing(one, "one cell");
    expect_nothing(Terrain{}, "no map");
}

TEST(FeatureFinder, a_riser_at_the_border_of_the_map_does_not_invent_a_flight) {
    const TestFlight flight{.steps = 6};
    // The map shows 50 mm of the first tread.
    const TestMap map(ground_of(flight), 0.0, {2.45, 0.0});
    for (const Flight& f : find(map.terrain()).flights) EXPECT_EQ(f.steps, 1);
}

/// A camera 1 m above the position, pitched 32 deg down, like the ZED of the REX.
View view_from(const TestMap& map, double x_m, double yaw_rad) {
    const Eigen::Vector2d p_m = map.to_map({x_m, 0.0});
    const double pitch_rad = 32.0 * kRadPerDeg;
    Eigen::Matrix3d level_camera;  // columns: right, down, ahead of a camera that looks along +x
    level_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    View view;
    view.T_map_camera.translation_m = {p_m.x(), p_m.y(), 1.0};
    view.T_map_camera.rotation = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) *
                                 Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()) *
                                 Eigen::Quaterniond(level_camera);
    view.width_px = 672.0;
    view.height_px = 376.0;
    view.fx_px = view.fy_px = 350.0;
    view.cx_px = 336.0;
    view.cy_px = 188.0;
    view.baseline_m = 0.12;
    return view;
}

TEST(FeatureFinder, ground_that_ends_in_sight_is_a_drop_whose_bottom_is_not_seen) {
    TestMap map([](double x_m, double) { return x_m < 1.5 ? 0.0 : -3.0; }, 0.6, {-0.8, -0.6});
    for (std::size_t i = 0; i < map.height_m.size(); ++i)
        if (map.height_m.data()[i] < -1.0F) map.height_m.data()[i] = kNanF;
    Terrain terrain = map.terrain({0.0, 0.0});
    EXPECT_TRUE(find(terrain).drops.empty());  // without a view, ground that ends is no drop
    terrain.view = view_from(map, 0.0, 0.6);
    const TerrainFeatures found = find(terrain);
    ASSERT_EQ(found.drops.size(), 1U);
    EXPECT_FALSE(found.drops[0].bottom_seen);
    EXPECT_NEAR(map.to_world(found.drops[0].pose.p_m.head<2>()).x(), 1.5, 0.02);
    // The end of the view itself is no drop.
    terrain.view = view_from(map, 0.0, 0.6 + 2.5);
    EXPECT_TRUE(find(terrain).drops.empty());
}

TEST(FeatureFinder, points_on_a_riser_place_its_edge_where_cells_before_it_hold_some) {
    const TestFlight flight{.steps = 3, .riser_m = 0.18, .going_m = 0.31};
    const double yaw_rad = 0.3;
    TestMap map(ground_of(flight), yaw_rad, {0.0, 0.0});
    // Depth noise puts points of each riser into the two cells before and behind it.
    grid::Layer density(map.geometry.nx, map.geometry.ny, 0.7F);
    for (int iy = 0; iy < map.geometry.ny; ++iy) {
        for (int ix = 0; ix < map.geometry.nx; ++ix) {
            const Eigen::Vector2d p_m = map.to_world(map.geometry.center_m({ix, iy}));
            for (int step = 0; step < 3; ++step) {
                const double s_m = p_m.x() - 0.31 * step;
                if (std::abs(p_m.y()) > 0.6 || std::abs(s_m) > 0.05) continue;
                density.at(ix, iy) = 8.0F;
                if (s_m < 0.0) map.height_m.at(ix, iy) += 0.16F;
            }
        }
    }
    Terrain terrain = map.terrain();
    const double without_m = map.to_world(find(terrain).flights.at(0).pose.p_m.head<2>()).x();
    EXPECT_LT(without_m, -0.02);
    terrain.density_ratio = density.view();
    const TerrainFeatures found = find(terrain);
    ASSERT_EQ(found.flights.size(), 1U);
    EXPECT_NEAR(map.to_world(found.flights[0].pose.p_m.head<2>()).x(), 0.0, 0.003);
    EXPECT_NEAR(found.flights[0].going_m, 0.31, 0.002);
}

TEST(FeatureFinder, a_last_step_unlike_the_others_joins_their_flight) {
    // A flight of three equal steps that are placed together, and a lower step with a short tread.
    const TestFlight flight{.steps = 3, .riser_m = 0.18, .going_m = 0.31};
    const auto ground = [&](double x_m, double y_m) {
        if (std::abs(y_m) > 0.6 || x_m < 3 * 0.31) return flight.at(x_m, y_m);
        return x_m < 3 * 0.31 + 0.4 ? 3 * 0.18 + 0.12 : 2.0;
    };
    for (const double yaw_deg : kYaws_deg) {
        const TestMap map(ground, yaw_deg * kRadPerDeg, {0.0, 0.0});
        const TerrainFeatures found = find(map.terrain());
        SCOPED_TRACE(::testing::Message() << yaw_deg << " deg");
        ASSERT_EQ(found.flights.size(), 1U);
        EXPECT_EQ(found.flights[0].steps, 4);
    }
}

TEST(FeatureFinder, a_step_whose_face_is_seen_raggedly_between_two_others_is_one) {
    const TestFlight flight{.steps = 5, .riser_m = 0.18, .going_m = 0.31};
    constexpr double kRaggedStep_m = 2 * 0.31;
    const auto ground = [&](double x_m, double y_m) {
        // The face of the third step is measured too near on one side and too far on the other
        // side.
        const bool near = std::abs(x_m - kRaggedStep_m) < 0.12;
        const double way = std::abs(y_m) < 0.12 ? 0.0 : y_m > 0.0 ? 0.11 : -0.11;
        return flight.at(near ? x_m + way : x_m, y_m);
    };
    for (const double yaw_deg : kYaws_deg) {
        const TestMap map(ground, yaw_deg * kRadPerDeg, {0.0, 0.0});
        const TerrainFeatures found = find(map.terrain());
        SCOPED_TRACE(::testing::Message() << yaw_deg << " deg");
        ASSERT_EQ(found.flights.size(), 1U);
        EXPECT_EQ(found.flights[0].steps, 5);
        EXPECT_NEAR(found.flights[0].riser_m, 0.18, 0.003);
        EXPECT_NEAR(found.flights[0].going_m, 0.31, 0.015);
    }
}

TEST(FeatureFinder, the_same_map_gives_the_same_features) {
    const TestFlight flight{.steps = 4};
    TestMap map(ground_of(flight), 0.7, {0.0, 0.0});
    map.add_noise(0.004, 2);
    FeatureFinder finder{StairsConfig{}};
    TerrainFeatures first;
    TerrainFeatures second;
    finder.find(map.terrain(), first);
    finder.find(map.terrain(), second);
    ASSERT_EQ(first.edges.size(), second.edges.size());
    for (std::size_t i = 0; i < first.edges.size(); ++i) {
        EXPECT_EQ(first.edges[i].from_m, second.edges[i].from_m);
        EXPECT_EQ(first.edges[i].upper_m, second.edges[i].upper_m);
    }
    EXPECT_EQ(first.flights.at(0).riser_m, second.flights.at(0).riser_m);
}

}  // namespace
}  // namespace surefoot::stairs
