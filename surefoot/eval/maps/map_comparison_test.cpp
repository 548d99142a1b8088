// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/maps/map_comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::eval {
namespace {

constexpr double kSigma_m = 0.003;

/// A floor with a 0.2 m block on it, seen from x = -1; the noise of the live map matches its sigma.
MapPair floor_with_block() {
    Rng rng(1);
    MapPair maps;
    maps.geometry = {0.05, 80, 80, {0.0, -2.0}};
    maps.truth_m = grid::Layer(80, 80, 0.0F);
    for (int iy = 30; iy < 50; ++iy)
        for (int ix = 50; ix < 70; ++ix) maps.truth_m.at(ix, iy) = 0.2F;
    maps.live_m = maps.truth_m;
    for (std::size_t i = 0; i < maps.live_m.size(); ++i)
        maps.live_m.data()[i] += static_cast<float>(kSigma_m * rng.normal());
    maps.live_m.at(0, 0) = kNanF;
    maps.live_var_m2 = grid::Layer(80, 80, static_cast<float>(kSigma_m * kSigma_m));
    maps.truth_traversability = grid::Layer(80, 80, 1.0F);
    maps.live_traversability = grid::Layer(80, 80, 1.0F);
    return maps;
}

std::int64_t cells_in(const std::vector<ErrorBin>& bins) {
    return std::accumulate(bins.begin(), bins.end(), std::int64_t{0}, [](auto sum, const auto& b) {
        return sum + b.errors.count;
    });
}

TEST(MapComparison, WithoutPosesAndVariance) {
    MapPair maps = floor_with_block();
    maps.live_var_m2 = {};
    const MapComparison result = compare_maps(maps, {});
    EXPECT_TRUE(result.by_distance.empty());
    EXPECT_TRUE(result.by_column.empty());
    EXPECT_TRUE(result.edges_by_column.empty());
    EXPECT_EQ(result.sigma.count, 0);
    EXPECT_TRUE(std::isnan(result.sigma.within_1_sigma));
    EXPECT_EQ(result.elevation.count, 6399);
    EXPECT_EQ(result.coverage, 6399.0 / 6400.0);
    EXPECT_EQ(result.traversability.true_safe, 1.0);
}

TEST(MapComparison, FloorFiguresAreThoseOfTheNoise) {
    const MapComparison result = compare_maps(floor_with_block(), {});
    // The block and two cells around each side of its edge are out, the unknown cell too.
    EXPECT_EQ(result.floor.count, 6400 - 26 * 26 - 1);
    EXPECT_NEAR(result.floor.spread_m, kSigma_m, 0.08 * kSigma_m);
    EXPECT_NEAR(result.edges.p99_abs, 2.576 * std::sqrt(2.0) * kSigma_m, 0.1 * 0.011);
    EXPECT_EQ(result.sigma.count, 6400 - 26 * 26 + 14 * 14 - 1);
    EXPECT_NEAR(result.sigma.within_1_sigma, 0.683, 0.03);
    EXPECT_NEAR(result.sigma.within_3_sigma, 0.997, 0.004);
}

TEST(MapComparison, ErrorsGoToTheirDistanceAndColumn) {
    MapPair maps = floor_with_block();
    maps.trajectory.resize(1);
    maps.trajectory[0].T_world_body.translation_m = {-1.0, 0.0, 1.0};
    CameraTrack camera;
    camera.view = {672, 376, 350.0, 350.0, 335.5, 187.5};
    const Pose T_body_camera{exp_so3({0.0, 0.5, 0.0}), {0.0, 0.0, 0.0}};  // 29 deg down
    camera.T_world_camera = {
        {0, maps.trajectory[0].T_world_body * T_body_camera * T_body_optical()}};
    maps.camera = camera;
    // The left of the floor (y > 1) is 0.05 m too high: the left of the image.
    for (int iy = 61; iy < 80; ++iy)
        for (int ix = 0; ix < 80; ++ix) maps.live_m.at(ix, iy) += 0.05F;
    const MapComparison result = compare_maps(maps, {});
    const std::int64_t away = result.elevation_away_from_edges.count;
    EXPECT_EQ(cells_in(result.by_distance), away);
    EXPECT_EQ(cells_in(result.by_range), cells_in(result.by_column));
    EXPECT_GT(cells_in(result.by_column), away / 2);
    ASSERT_EQ(result.by_column.size(), 8u);
    EXPECT_EQ(result.by_column.front().from, -0.5);
    EXPECT_EQ(result.by_column.back().to, 671.5);
    EXPECT_GT(result.by_column[0].errors.median_abs, 0.045);
    EXPECT_LT(result.by_column[7].errors.median_abs, 0.005);
    EXPECT_LT(result.by_distance[2].errors.median_abs, 0.005);  // 1.0 .. 1.5 m: straight ahead
    EXPECT_EQ(result.by_distance[0].errors.count, 0);           // the map begins 1 m ahead
    // The jump where the shifted part begins is an edge on the left side, none on the right.
    EXPECT_GT(result.edges_by_column[1].errors.max_abs, 0.035);
    EXPECT_LT(result.edges_by_column[6].errors.max_abs, 0.025);
}

TEST(MapComparison, AMapThatKnowsNothing) {
    MapPair maps = floor_with_block();
    maps.live_m.fill(kNanF);
    maps.live_traversability.fill(kNanF);
    const MapComparison result = compare_maps(maps, {});
    EXPECT_EQ(result.elevation.count, 0);
    EXPECT_EQ(result.coverage, 0.0);
    EXPECT_EQ(result.floor.count, 0);
    EXPECT_EQ(result.edges.count, 0);
    EXPECT_EQ(result.traversability.unknown, 1.0);
}

}  // namespace
}  // namespace surefoot::eval
