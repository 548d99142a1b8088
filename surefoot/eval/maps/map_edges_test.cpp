// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/maps/map_edges.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/eval/report/error_bins.hpp"

namespace surefoot::eval {
namespace {

/// Rows from the smallest y up.
grid::Layer layer_of(int nx, const std::vector<float>& values) {
    grid::Layer layer(nx, static_cast<int>(values.size()) / nx);
    std::copy(values.begin(), values.end(), layer.data());
    return layer;
}

template <typename T>
Image<T> mirrored(const Image<T>& in) {
    Image<T> out = in;
    for (int v = 0; v < in.height(); ++v)
        for (int u = 0; u < in.width(); ++u) out.at(u, v) = in.at(in.width() - 1 - u, v);
    return out;
}

TEST(HeightJumps, ByHandWithAHole) {
    const auto height = layer_of(3,
                                 {0.0F,
                                  1.0F,
                                  kNanF,  //
                                  4.0F,
                                  2.0F,
                                  7.0F});
    const auto key = layer_of(3,
                              {0.0F,
                               2.0F,
                               4.0F,  //
                               10.0F,
                               12.0F,
                               14.0F});
    const HeightJumps jumps = height_jumps(height, {}, key);
    // (0,0): right 1, up 4; (1,0): up 1; (0,1): right -2; (1,1): right 5. The hole makes none.
    EXPECT_EQ(jumps.jump_m, (std::vector<float>{1.0F, 4.0F, 1.0F, -2.0F, 5.0F}));
    EXPECT_EQ(jumps.key, (std::vector<float>{1.0F, 5.0F, 7.0F, 11.0F, 13.0F}));
    const ErrorFigures figures = error_figures(jumps.jump_m);
    EXPECT_EQ(figures.median_abs, 2.0);
    EXPECT_EQ(figures.max_abs, 5.0);
}

TEST(HeightJumps, BothCellsMustBeInTheMask) {
    const auto height = layer_of(3, {0.0F, 1.0F, 3.0F});
    CellMask mask(3, 1, 1);
    mask.at(2, 0) = 0;
    const HeightJumps jumps = height_jumps(height, mask, {});
    EXPECT_EQ(jumps.jump_m, std::vector<float>{1.0F});
    ASSERT_EQ(jumps.key.size(), 1u);
    EXPECT_TRUE(std::isnan(jumps.key[0]));
}

TEST(HeightJumps, NothingHasNoNeighbours) {
    EXPECT_TRUE(height_jumps({}, {}, {}).jump_m.empty());
    EXPECT_TRUE(height_jumps(layer_of(1, {3.0F}), {}, {}).jump_m.empty());
    EXPECT_TRUE(height_jumps(grid::Layer(4, 4, kNanF), {}, {}).jump_m.empty());
}

TEST(HeightJumps, AJaggedSideIsFoundInItsColumns) {
    // Seen columns grow with -y: the right of the image is the lower part of the map.
    Rng rng(1);
    grid::Layer height(40, 40), column(40, 40);
    for (int iy = 0; iy < 40; ++iy) {
        for (int ix = 0; ix < 40; ++ix) {
            column.at(ix, iy) = 10.0F * static_cast<float>(39 - iy);
            const double sigma_m = iy < 5 ? 0.02 : 0.001;
            height.at(ix, iy) = static_cast<float>(sigma_m * rng.normal());
        }
    }
    const HeightJumps jumps = height_jumps(height, {}, column);
    EXPECT_EQ(jumps.jump_m.size(), 2u * 40u * 39u);
    const auto bins = by_bins(jumps.jump_m, jumps.key, std::vector<double>{0, 100, 200, 300, 390});
    // A difference of two draws: sqrt(2) sigma; 2.58 of them are the 99 % of a normal.
    EXPECT_NEAR(bins[0].errors.p99_abs, 0.001 * std::sqrt(2.0) * 2.576, 0.0008);
    EXPECT_GT(bins[3].errors.p99_abs, 0.05);
    // The picture of the other side is the same with the columns turned round.
    EXPECT_EQ(error_figures(height_jumps(mirrored(height), {}, {}).jump_m).p99_abs,
              error_figures(jumps.jump_m).p99_abs);
}

TEST(LevelFloor, IsTheLargestLevelSurfaceAwayFromEdges) {
    // A floor of 20 columns, a table of 8 columns 0.7 m higher, unknown beyond.
    grid::Layer truth(30, 10, kNanF);
    for (int iy = 0; iy < 10; ++iy)
        for (int ix = 0; ix < 28; ++ix) truth.at(ix, iy) = ix < 20 ? 0.0F : 0.7F;
    const CellMask mask = level_floor(truth, {});
    for (int iy = 0; iy < 10; ++iy) {
        // The edge cell 19 and two more are left out.
        for (int ix = 0; ix < 30; ++ix) EXPECT_EQ(mask.at(ix, iy), ix < 17 ? 1 : 0) << ix;
    }
}

TEST(LevelFloor, KeepsWhatIsWithinTheBandOnly) {
    const auto truth = layer_of(6, {0.010F, 0.011F, 0.0139F, 0.020F, 0.021F, kNanF});
    const CellMask mask = level_floor(truth, {});
    const std::vector<int> expected = {1, 1, 1, 0, 0, 0};
    for (int ix = 0; ix < 6; ++ix)
        EXPECT_EQ(mask.at(ix, 0), expected[static_cast<std::size_t>(ix)]);
    // Two equal surfaces: the lower one counts; the unknown cell between them makes no edge.
    const CellMask lower = level_floor(layer_of(5, {0.5F, 0.5F, kNanF, 0.1F, 0.1F}), {});
    EXPECT_EQ(lower.at(0, 0), 0);
    EXPECT_EQ(lower.at(3, 0), 1);
    const CellMask other_side = level_floor(layer_of(5, {0.1F, 0.1F, kNanF, 0.5F, 0.5F}), {});
    EXPECT_EQ(other_side.at(0, 0), 1);
    EXPECT_EQ(other_side.at(3, 0), 0);
    const CellMask none = level_floor(grid::Layer(3, 3, kNanF), {});
    for (std::size_t i = 0; i < none.size(); ++i) EXPECT_EQ(none.data()[i], 0);
}

TEST(FloorSpread, FindsTheNoiseOfATiltedFloorDespiteOutliers) {
    Rng rng(2);
    const grid::GridGeometry geometry{0.025, 100, 100, {-1.0, 0.3}};
    constexpr double kSigma_m = 0.004;
    constexpr double kSlope = 0.02;  // 1:50
    grid::Layer height(100, 100);
    for (int iy = 0; iy < 100; ++iy) {
        for (int ix = 0; ix < 100; ++ix) {
            const double plane_m = kSlope * geometry.center_m({ix, iy}).x() - 0.7;
            height.at(ix, iy) = static_cast<float>(plane_m + kSigma_m * rng.normal());
        }
    }
    FloorSpread spread = floor_spread(geometry, height, {});
    EXPECT_EQ(spread.count, 10000);
    // A standard deviation of 10000 draws is known to 0.7 %, their MAD to 1.2 %; 4 times that.
    EXPECT_NEAR(spread.rms_m, kSigma_m, 0.028 * kSigma_m);
    EXPECT_NEAR(spread.spread_m, kSigma_m, 0.048 * kSigma_m);
    EXPECT_NEAR(spread.p99_abs_m, 2.576 * kSigma_m, 0.1 * 2.576 * kSigma_m);
    EXPECT_NEAR(spread.tilt_deg, std::atan(kSlope) * 180.0 / M_PI, 0.02);

    // A box of 3 % of the cells lifts the rms, not the spread nor the plane.
    for (int iy = 0; iy < 30; ++iy)
        for (int ix = 0; ix < 10; ++ix) height.at(ix, iy) += 0.3F;
    spread = floor_spread(geometry, height, {});
    EXPECT_NEAR(spread.tilt_deg, std::atan(kSlope) * 180.0 / M_PI, 0.02);
    EXPECT_NEAR(spread.spread_m, kSigma_m, 0.1 * kSigma_m);
    EXPECT_NEAR(spread.rms_m, 0.3 * std::sqrt(0.03), 0.002);
}

TEST(FloorSpread, ExactPlaneAndMask) {
    const grid::GridGeometry geometry{0.5, 3, 3, {0.0, 0.0}};
    auto height = layer_of(3, {0.F, 1.F, 2.F, 0.F, 1.F, 2.F, 0.F, 1.F, 9.F});  // 1 m per 0.5 m
    CellMask mask(3, 3, 1);
    mask.at(2, 2) = 0;
    FloorSpread spread = floor_spread(geometry, height, mask);
    EXPECT_EQ(spread.count, 8);
    EXPECT_NEAR(spread.rms_m, 0.0, 1e-12);
    EXPECT_NEAR(spread.tilt_deg, std::atan(2.0) * 180.0 / M_PI, 1e-9);
    height.at(0, 0) = kNanF;
    EXPECT_EQ(floor_spread(geometry, height, mask).count, 7);
}

TEST(FloorSpread, NoPlaneIsNan) {
    const grid::GridGeometry row{0.5, 3, 1, {0.0, 0.0}};
    for (const auto& height :
         {layer_of(3, {kNanF, kNanF, kNanF}),
          layer_of(3, {1.F, kNanF, kNanF}),
          layer_of(3, {1.F, 1.F, 1.F})}) {  // cells in one line have no one plane
        const FloorSpread spread = floor_spread(row, height, {});
        EXPECT_EQ(spread.count, 0);
        EXPECT_TRUE(std::isnan(spread.spread_m));
    }
}

}  // namespace
}  // namespace surefoot::eval
