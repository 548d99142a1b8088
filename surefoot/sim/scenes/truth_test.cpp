// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/truth.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/sim/motion/planar.hpp"
#include "surefoot/sim/scenes/scenes.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

namespace surefoot::sim {
namespace {

SceneTruth truth_from(const char* scene, double x_m) {
    SceneTruth truth;
    truth.scene = make_scene(scene, 1).value().scene;
    truth.rig = rig_preset("zed_vga").value();
    Pose T_world_body;
    T_world_body.translation_m = {x_m, 0.0, kBodyHeight_m};
    truth.trajectory.push_back({0, T_world_body});
    return truth;
}

/// Whether this point is on or below the board of the scene `table`.
bool under_board(const ScriptedScene& table, const Eigen::Vector2d& p_m) {
    const auto T_world_side = PlanarPose::of(
        drawn_number(table, "distance_m"), 0.0, kRadPerDeg * drawn_number(table, "angle_deg"));
    const Eigen::Vector2d p_side_m = T_world_side.inverse_times(p_m);
    const double across_m = p_side_m.y() - drawn_number(table, "lateral_m");
    return p_side_m.x() >= 0.0 && p_side_m.x() <= drawn_number(table, "length_m") &&
           std::abs(across_m) <= 0.5 * drawn_number(table, "width_m");
}

Image<std::uint8_t> seen(const SceneTruth& truth, const Lattice& lattice, double range_m) {
    VisibilityConfig config;
    config.range_m = range_m;
    Serial serial;
    return visibility_mask(truth, lattice, config, serial);
}

TEST(TruthTest, StepsHaveTheirExactHeightsUpToTheCellBorder) {
    const ScriptedScene demo = make_scene("demo_stairs", 1).value();
    // Row of 25 mm cells along y = 0; the first riser is a border of cells.
    const double riser_m = drawn_number(demo, "stair_x_m");
    const Lattice row{{riser_m - 0.1, 0.0}, 50, 1, 0.025};
    const Image<float> heights_m = dem(demo.scene, row);
    const Image<Label> kinds = labels(demo.scene, row);
    for (int ix = 0; ix < row.nx; ++ix) {
        const double end_m = row.origin_m.x() + row.resolution_m * (ix + 1);
        float expected_m = 0.0F;
        if (end_m > riser_m + 1e-5) expected_m = 0.18F;
        if (end_m > riser_m + 0.31 + 1e-5) expected_m = 0.36F;
        if (end_m > riser_m + 0.62 + 1e-5) expected_m = 0.54F;
        EXPECT_EQ(heights_m.at(ix, 0), expected_m) << "cell ending at " << end_m;
        EXPECT_EQ(kinds.at(ix, 0), end_m > riser_m + 1e-5 ? Label::step : Label::floor);
    }
}

TEST(TruthTest, DemKnowsTableRampPitAndTheEndOfTheGround) {
    const ScriptedScene demo = make_scene("demo_stairs", 1).value();
    const Scene& scene = demo.scene;
    const auto table_m = static_cast<float>(drawn_number(demo, "table_top_m"));
    const auto pit_m = static_cast<float>(-drawn_number(demo, "pit_depth_m"));
    const double ramp_x_m = drawn_number(demo, "ramp_x_m");
    const auto height = [&](double x_m, double y_m, DemReduce reduce) {
        return dem(scene, {{x_m - 0.01, y_m - 0.01}, 1, 1, 0.02}, reduce).at(0, 0);
    };
    for (const DemReduce reduce : {DemReduce::highest, DemReduce::center}) {
        EXPECT_EQ(height(2.4, 1.1, reduce), table_m);
        EXPECT_EQ(height(2.0, -1.3, reduce), pit_m);
        EXPECT_TRUE(std::isnan(height(30.0, 0.0, reduce)));
        // 1:8 ramp; the highest point of the cell is half a cell further up.
        const double half_m = reduce == DemReduce::highest ? 0.01 : 0.0;
        EXPECT_NEAR(height(3.6, -1.3, reduce), (3.6 + half_m - ramp_x_m) / 8.0, 1e-6);
    }
    EXPECT_EQ(labels(scene, {{1.9, -1.3}, 1, 1, 0.02}).at(0, 0), Label::drop);
    EXPECT_EQ(labels(scene, {{4.0, -1.3}, 1, 1, 0.02}).at(0, 0), Label::ramp);
    EXPECT_EQ(labels(scene, {{30.0, 0.0}, 1, 1, 0.02}).at(0, 0), Label::none);
}

TEST(TruthTest, EdgesAreMaskedWithTheirMargin) {
    Image<float> heights_m(9, 3, 0.0F);
    for (int iy = 0; iy < 3; ++iy) {
        for (int ix = 5; ix < 9; ++ix) heights_m.at(ix, iy) = 0.031F;
    }
    const Image<std::uint8_t> mask = edge_mask(heights_m);
    for (int ix = 0; ix < 9; ++ix) EXPECT_EQ(mask.at(ix, 1), ix >= 2 && ix <= 7 ? 1 : 0) << ix;

    Image<float> low = heights_m;
    for (int iy = 0; iy < 3; ++iy) {
        for (int ix = 5; ix < 9; ++ix) low.at(ix, iy) = 0.029F;
    }
    EXPECT_EQ(edge_mask(low), Image<std::uint8_t>(9, 3));
    Image<float> hole(9, 3, 0.0F);
    hole.at(0, 0) = kNanF;
    const Image<std::uint8_t> beside_hole = edge_mask(hole);
    EXPECT_EQ(beside_hole.at(0, 0), 1);
    EXPECT_EQ(beside_hole.at(3, 0), 1);
    EXPECT_EQ(beside_hole.at(4, 0), 0);
    EXPECT_TRUE(edge_mask(Image<float>()).empty());
}

TEST(TruthTest, TheNearestVisibleFloorFollowsFromPitchAndFieldOfView) {
    const SceneTruth truth = truth_from("floor", 0.0);
    // Straight ahead of the left camera (y = 0.25, 1 m high, 0.075 m ahead of base_link): the
    // lowest pixel row looks 32 deg + atan(188 / 342) down.
    const double lowest_rad = 32.0 * std::acos(-1.0) / 180.0 + std::atan(188.0 / 342.0);
    const double nearest_m = 0.075 + 1.0 / std::tan(lowest_rad);
    const double farthest_m = 0.075 + std::sqrt(2.5 * 2.5 - 1.0);
    const Lattice row{{0.0, 0.245}, 400, 1, 0.01};
    const Image<std::uint8_t> mask = seen(truth, row, 2.5);
    for (int ix = 0; ix < row.nx; ++ix) {
        const double x_m = row.center_m(ix, 0).x();
        EXPECT_EQ(mask.at(ix, 0), x_m > nearest_m && x_m < farthest_m ? 1 : 0) << "x = " << x_m;
    }
}

TEST(TruthTest, ATableHidesWhatIsBehind) {
    const SceneTruth truth = truth_from("table", 0.0);
    const ScriptedScene table = make_scene("table", 1).value();
    const double top_m = drawn_number(table, "top_m");
    const Eigen::Vector2d camera_m(0.075, 0.25);  // the left one, 1 m high
    const Lattice row{{drawn_number(table, "distance_m") - 0.1, 0.0}, 400, 1, 0.02};
    const Image<std::uint8_t> mask = seen(truth, row, 50.0);
    int hidden = 0;
    int on_top = 0;
    for (int ix = 0; ix < row.nx; ++ix) {
        const Eigen::Vector2d p_m = row.center_m(ix, 0);
        // The line of sight to ground crosses the heights of the board on this part of its way.
        const Eigen::Vector2d over_m = camera_m + (1.0 - top_m) * (p_m - camera_m);
        const Eigen::Vector2d under_m = camera_m + (1.03 - top_m) * (p_m - camera_m);
        if (under_board(table, p_m)) {
            EXPECT_EQ(mask.at(ix, 0), 1) << "table top at " << p_m.x();
            ++on_top;
        } else if (under_board(table, over_m) || under_board(table, under_m)) {
            EXPECT_EQ(mask.at(ix, 0), 0) << "x = " << p_m.x();
            ++hidden;
        }
    }
    EXPECT_GT(on_top, 20);
    EXPECT_GT(hidden, 50);
}

TEST(TruthTest, TheRimOfAPitHidesItsNearBottom) {
    const SceneTruth demo = truth_from("demo_stairs", 0.0);
    const ScriptedScene drawn = make_scene("demo_stairs", 1).value();
    const double rim_y_m = drawn_number(drawn, "pit_y_m");
    const double depth_m = drawn_number(drawn, "pit_depth_m");
    // From y = 0.25, 1 m high, over the rim; the far one is 0.9 m behind it.
    const Lattice column{{2.2, rim_y_m - 0.89}, 1, 88, 0.01};
    const Image<std::uint8_t> bottom = seen(demo, column, 50.0);
    for (int iy = 0; iy < column.ny; ++iy) {
        const double y_m = column.center_m(0, iy).y();
        const double visible_below_y_m = rim_y_m - depth_m * (0.25 - rim_y_m);
        EXPECT_EQ(bottom.at(0, iy), y_m < visible_below_y_m ? 1 : 0) << "y = " << y_m;
    }
}

TEST(TruthTest, MinimumFramesAndStrideAreRespected) {
    SceneTruth truth = truth_from("floor", 0.0);
    truth.trajectory.push_back(truth.trajectory.front());
    truth.trajectory.push_back(truth.trajectory.front());
    const Lattice cell{{1.5, 0.2}, 1, 1, 0.025};
    Serial serial;
    const auto mask = [&](int min_frames, int stride) {
        VisibilityConfig config;
        config.min_frames = min_frames;
        config.frame_stride = stride;
        return visibility_mask(truth, cell, config, serial).at(0, 0);
    };
    EXPECT_EQ(mask(3, 1), 1);
    EXPECT_EQ(mask(4, 1), 0);
    EXPECT_EQ(mask(2, 2), 1);
    EXPECT_EQ(mask(3, 2), 0);
}

}  // namespace
}  // namespace surefoot::sim
