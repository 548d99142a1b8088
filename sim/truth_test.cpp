// SPDX-License-Identifier: Apache-2.0
#include "sim/truth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/rigs.hpp"
#include "sim/scenes.hpp"

namespace surefoot::sim {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

SceneTruth truth_from(const char* scene, double x_m) {
    SceneTruth truth;
    truth.scene = make_scene(scene, 1).value().scene;
    truth.rig = rig_preset("zed_vga").value();
    Pose T_world_body;
    T_world_body.translation_m = {x_m, 0.0, kBodyHeight_m};
    truth.trajectory.push_back({0, T_world_body});
    return truth;
}

Image<std::uint8_t> seen(const SceneTruth& truth, const Lattice& lattice, double range_m) {
    VisibilityConfig config;
    config.range_m = range_m;
    Serial serial;
    return visibility_mask(truth, lattice, config, serial);
}

TEST(TruthTest, StepsHaveTheirExactHeightsUpToTheCellBorder) {
    const Scene scene = make_scene("demo_stairs", 1).value().scene;
    // Row of 25 mm cells along y = 0; the first riser at x = 3.6 is a border of cells.
    const Lattice row{{3.5, 0.0}, 50, 1, 0.025};
    const Image<float> heights_m = dem(scene, row);
    const Image<Label> kinds = labels(scene, row);
    for (int ix = 0; ix < row.nx; ++ix) {
        const double end_m = row.origin_m.x() + row.resolution_m * (ix + 1);
        float expected_m = 0.0F;
        if (end_m > 3.6 + 1e-5) expected_m = 0.18F;
        if (end_m > 3.91 + 1e-5) expected_m = 0.36F;
        if (end_m > 4.22 + 1e-5) expected_m = 0.54F;
        EXPECT_EQ(heights_m.at(ix, 0), expected_m) << "cell ending at " << end_m;
        EXPECT_EQ(kinds.at(ix, 0), end_m > 3.6 + 1e-5 ? Label::step : Label::floor);
    }
}

TEST(TruthTest, DemKnowsTableRampPitAndTheEndOfTheGround) {
    const Scene scene = make_scene("demo_stairs", 1).value().scene;
    const auto height = [&](double x_m, double y_m, DemReduce reduce) {
        return dem(scene, {{x_m - 0.01, y_m - 0.01}, 1, 1, 0.02}, reduce).at(0, 0);
    };
    for (const DemReduce reduce : {DemReduce::highest, DemReduce::center}) {
        EXPECT_EQ(height(2.4, 1.1, reduce), 0.72F);
        EXPECT_EQ(height(2.0, -1.3, reduce), -0.25F);
        EXPECT_TRUE(std::isnan(height(30.0, 0.0, reduce)));
        // 1:8 ramp; the highest point of the cell is half a cell further up.
        const double half_m = reduce == DemReduce::highest ? 0.01 : 0.0;
        EXPECT_NEAR(height(3.6, -1.25, reduce), (3.6 + half_m - 2.8) / 8.0, 1e-6);
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
    hole.at(0, 0) = kNan;
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

TEST(TruthTest, ATableAndAPitEdgeHideWhatIsBehind) {
    // Behind the table at x = 2.2..3.0, 0.72 high, seen from 1 m: shadow up to 3.0 + 0.72 / slope.
    const SceneTruth truth = truth_from("table", 0.0);
    const double camera_x_m = 0.075;
    const double shadow_end_m = camera_x_m + (3.0 - camera_x_m) / 0.28;
    const Lattice row{{2.2, 0.0}, 400, 1, 0.02};
    const Image<std::uint8_t> mask = seen(truth, row, 50.0);
    const double shadow_begin_m = camera_x_m + (2.2 - camera_x_m) / 0.31;  // under the board
    int hidden = 0;
    for (int ix = 0; ix < row.nx; ++ix) {
        const double x_m = row.center_m(ix, 0).x();
        if (x_m < 3.0) {
            EXPECT_EQ(mask.at(ix, 0), 1) << "table top at " << x_m;
        }
        if (x_m > shadow_begin_m && x_m < shadow_end_m) {
            EXPECT_EQ(mask.at(ix, 0), 0) << "x = " << x_m;
            ++hidden;
        }
    }
    EXPECT_GT(hidden, 50);

    const SceneTruth demo = truth_from("demo_stairs", 0.0);
    // From y = 0.25 over the rim at y = -0.8: the first 0.25 * 1.05 m of the bottom are hidden.
    const Lattice column{{2.2, -1.69}, 1, 88, 0.01};
    const Image<std::uint8_t> bottom = seen(demo, column, 50.0);
    for (int iy = 0; iy < column.ny; ++iy) {
        const double y_m = column.center_m(0, iy).y();
        const double visible_below_y_m = -0.8 - 0.25 * (0.8 + 0.25);
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
