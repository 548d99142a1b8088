// SPDX-License-Identifier: Apache-2.0
#include "studies/lange2016/thesis_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "surefoot/core/rng.hpp"

namespace surefoot::app {
namespace {

constexpr double kResolution_m = 0.025;

using Ground = std::function<double(double x_m, double y_m)>;

/// Ground of 4 m x 4 m around the origin.
RatedMap map_of(const Ground& ground) {
    grid::GridGeometry g;
    g.nx = 160;
    g.ny = 160;
    g.resolution_m = kResolution_m;
    g.origin_m = {-2.0, -2.0};
    grid::Layer height_m(g.nx, g.ny, 0.0F);
    for (int iy = 0; iy < g.ny; ++iy) {
        for (int ix = 0; ix < g.nx; ++ix) {
            const Eigen::Vector2d at_m = g.center_m({ix, iy});
            height_m.at(ix, iy) = static_cast<float>(ground(at_m.x(), at_m.y()));
        }
    }
    return rated_map(g, height_m, {});
}

/// Steps of 0.18 m and 0.30 m up from x = 0.0, a wall to the left.
double stairs_m(double x_m, double y_m) {
    if (y_m > 1.8) return 1.5;
    return 0.18 * std::clamp(std::floor(x_m / 0.30) + 1.0, 0.0, 3.0);
}

TEST(CompareWithScan, TheSameMapAgrees) {
    const RatedMap truth = map_of(stairs_m);
    const ComparedMap same = compare_with_scan(truth, truth, {}, {});
    EXPECT_LT(same.figures.get("align_m"), 1e-6);
    for (const char* name :
         {"c2c_p90_m", "m3c2_p90_m", "height_p90_m", "edges_most_m", "floor_spread_m"})
        EXPECT_NEAR(same.figures.get(name), 0.0, 1e-6) << name;
    EXPECT_EQ(same.figures.get("false_safe"), 0.0);
    EXPECT_EQ(same.figures.get("false_unsafe"), 0.0);
}

TEST(CompareWithScan, ALiveMapThatLiesAskewIsLaidOntoTheScan) {
    const RatedMap truth = map_of(stairs_m);
    const RatedMap live =
        map_of([&](double x_m, double y_m) { return 0.008 + stairs_m(x_m, y_m) + 0.01 * y_m; });
    const ComparedMap compared = compare_with_scan(live, truth, {}, {});
    EXPECT_NEAR(compared.T_truth_live.translation_m.z(), -0.008, 0.001);
    EXPECT_NEAR(compared.figures.get("align_deg"), 0.01 * 180.0 / M_PI, 0.02);
    EXPECT_LT(compared.figures.get("height_p50_m"), 0.001);
    EXPECT_LT(compared.figures.get("m3c2_p50_m"), 0.001);
}

TEST(CompareWithScan, AStepThatTheMapDoesNotShowIsFalselySafe) {
    const RatedMap truth = map_of(stairs_m);
    const RatedMap live = map_of([](double x_m, double y_m) {
        return y_m > 1.8 ? 1.5 : 0.18 * std::clamp(x_m / 0.30, 0.0, 3.0) * 0.2;
    });
    const ComparedMap compared = compare_with_scan(live, truth, {}, {});
    EXPECT_GT(compared.figures.get("false_safe"), 0.05);
    EXPECT_GT(compared.figures.get("height_p90_m"), 0.05);
}

TEST(CompareWithScan, JaggedFloorsAreMeasuredOnTheFloorOfTheTruth) {
    const auto level = [](double, double) { return 0.0; };
    const RatedMap truth = map_of(level);
    const RatedMap live = map_of([](double x_m, double) {
        return std::fmod(std::floor(x_m / 0.5), 2.0) == 0.0 ? 0.02 : -0.02;
    });
    const ComparedMap compared = compare_with_scan(live, truth, {}, {});
    EXPECT_NEAR(compared.figures.get("edges_most_m"), 0.04, 1e-3);
    EXPECT_NEAR(compared.figures.get("floor_spread_m"), 1.4826 * 0.02, 2e-3);
}

TEST(MeasureByHand, StairsAndDoorsOfAMap) {
    ThesisFigures figures;
    const RatedMap map = map_of(stairs_m);
    measure_stairs(cell_points_m(map), {{-1.0, -0.5}, {1.8, 0.5}}, figures);
    EXPECT_NEAR(figures.get("riser_m"), 0.18, 1e-4);
    EXPECT_NEAR(figures.get("first_riser_m"), 0.18, 1e-4);
    EXPECT_EQ(figures.get("risers"), 3.0);
    EXPECT_NEAR(figures.get("going_m"), 0.30, 0.013);

    ThesisFigures none;
    measure_stairs(cell_points_m(map), {{-1.9, -1.0}, {-1.0, 1.0}}, none);
    EXPECT_EQ(none.get("risers"), 0.0);
    EXPECT_TRUE(std::isnan(none.get("riser_m")));

    // A wall across x = 0 with an opening of 1 m; the floor behind it lies 30 mm higher.
    const RatedMap door = map_of([](double x_m, double y_m) {
        if (std::abs(x_m) < 0.06 && std::abs(y_m) > 0.5) return 1.2;
        return x_m > 0.0 ? 0.03 : 0.0;
    });
    ThesisFigures passed;
    measure_door(cell_points_m(door), door, {0.0, 0.0}, passed);
    EXPECT_NEAR(passed.get("door_width_m"), 1.0, 0.03);
    EXPECT_NEAR(passed.get("floor_step_m"), 0.03, 1e-6);
}

}  // namespace
}  // namespace surefoot::app
