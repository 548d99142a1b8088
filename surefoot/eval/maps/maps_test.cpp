// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/maps/maps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::eval {
namespace {

grid::Layer row(std::initializer_list<float> values) {
    grid::Layer layer(static_cast<int>(values.size()), 1);
    std::copy(values.begin(), values.end(), layer.data());
    return layer;
}

grid::Layer numbered(const grid::GridGeometry& geometry) {
    grid::Layer layer(geometry.nx, geometry.ny);
    for (std::size_t i = 0; i < layer.size(); ++i) layer.data()[i] = static_cast<float>(i);
    return layer;
}

bool same(float a, float b) {
    return a == b || (std::isnan(a) && std::isnan(b));
}

TEST(Maps, AWholeCellShiftMovesNoValueIntoANeighbour) {
    // Origins whose distance is not exact in binary.
    const grid::GridGeometry from{0.025, 40, 30, {0.1, -0.3}};
    const grid::Layer layer = numbered(from);
    for (int shift = -45; shift <= 45; ++shift) {
        grid::GridGeometry to = from;
        to.origin_m.x() += shift * 0.025;
        to.origin_m.y() += 0.1;  // four cells
        const grid::Layer moved = resample_nearest(from, layer, to);
        for (int iy = 0; iy < to.ny; ++iy) {
            for (int ix = 0; ix < to.nx; ++ix) {
                const grid::Cell cell{ix + shift, iy + 4};
                const float expected = from.contains(cell) ? layer.at(cell.ix, cell.iy) : kNanF;
                ASSERT_TRUE(same(moved.at(ix, iy), expected)) << shift << " " << ix << " " << iy;
            }
        }
    }
}

TEST(Maps, AnyOtherLatticeTakesTheCellThatHoldsTheCentre) {
    Rng rng(5);
    for (int trial = 0; trial < 50; ++trial) {
        const grid::GridGeometry from{0.05, 17, 23, {rng.uniform(-1, 1), rng.uniform(-1, 1)}};
        const grid::GridGeometry to{
            rng.uniform(0.01, 0.2), 20, 15, {rng.uniform(-1, 1), rng.uniform(-1, 1)}};
        const grid::Layer layer = numbered(from);
        const grid::Layer moved = resample_nearest(from, layer, to);
        for (int iy = 0; iy < to.ny; ++iy) {
            for (int ix = 0; ix < to.nx; ++ix) {
                const Eigen::Vector2d center = to.center_m({ix, iy});
                const auto cell = from.cell_at(center.x(), center.y());
                const float expected = cell ? layer.at(cell->ix, cell->iy) : kNanF;
                ASSERT_TRUE(same(moved.at(ix, iy), expected)) << trial;
            }
        }
    }
}

TEST(Maps, ACentreOnABorderBelongsToTheGreaterIndex) {
    const grid::GridGeometry from{0.025, 200, 1, {0.3, 0.0}};
    grid::GridGeometry to = from;
    to.origin_m.x() += 0.0125;  // half a cell
    const grid::Layer moved = resample_nearest(from, numbered(from), to);
    for (int ix = 0; ix + 1 < 200; ++ix) EXPECT_EQ(moved.at(ix, 0), static_cast<float>(ix + 1));
    EXPECT_TRUE(std::isnan(moved.at(199, 0)));
}

TEST(Maps, EdgeMarginByItsDefinition) {
    Rng rng(6);
    for (int margin = 0; margin <= 3; ++margin) {
        grid::Layer height(25, 19, 0.0F);
        for (int k = 0; k < 6; ++k) height.at(int(rng.below(25)), int(rng.below(19))) = 0.1F;
        for (int k = 0; k < 40; ++k) height.at(int(rng.below(25)), int(rng.below(19))) = 0.03F;
        for (int k = 0; k < 20; ++k) height.at(int(rng.below(25)), int(rng.below(19))) = kNanF;
        EvalMapsConfig config;
        config.edge_margin_cells = margin;
        const CellMask mask = away_from_edges(height, config);
        const auto jumps = [&](int px, int py) {  // to any neighbour
            for (int k = 0; k < 9; ++k) {
                const int qx = px + k % 3 - 1;
                const int qy = py + k / 3 - 1;
                if (!height.contains(qx, qy)) continue;
                if (std::abs(double(height.at(px, py)) - double(height.at(qx, qy))) > 0.03)
                    return true;
            }
            return false;
        };
        for (int iy = 0; iy < 19; ++iy) {
            for (int ix = 0; ix < 25; ++ix) {
                bool keep = !std::isnan(height.at(ix, iy));
                for (int py = 0; py < 19; ++py) {
                    for (int px = 0; px < 25; ++px) {
                        const bool near = std::max(std::abs(px - ix), std::abs(py - iy)) <= margin;
                        if (near && jumps(px, py)) keep = false;
                    }
                }
                ASSERT_EQ(mask.at(ix, iy) != 0, keep) << margin << " " << ix << " " << iy;
            }
        }
    }
}

TEST(Maps, OneStepLeavesOutThreeCellsOnEachSide) {
    const CellMask mask = away_from_edges(row({0, 0, 0, 0, 0, .18F, .18F, .18F, .18F, .18F}), {});
    const std::vector<int> expected = {1, 1, 0, 0, 0, 0, 0, 0, 1, 1};
    for (int ix = 0; ix < 10; ++ix) EXPECT_EQ(mask.at(ix, 0), expected[std::size_t(ix)]) << ix;
}

TEST(Maps, ElevationErrorsOfASmallMap) {
    const grid::Layer truth = row({0, 0, 0, 0, 0, kNanF, 1});
    const grid::Layer live = row({0, -.01F, .02F, -.03F, .06F, 5, kNanF});
    const ElevationErrors errors = elevation_errors(live, truth, {}, {});
    constexpr double kFloat = 1e-8;  // 0.06 as float
    EXPECT_EQ(errors.count, 5);
    EXPECT_NEAR(errors.median_abs_m, 0.02, kFloat);
    EXPECT_NEAR(errors.p90_abs_m, 0.048, kFloat);  // rank 3.6 between 0.03 and 0.06
    EXPECT_NEAR(errors.mean_m, 0.008, kFloat);     // signs matter
    EXPECT_NEAR(errors.rmse_m, std::sqrt(0.001), kFloat);
    EXPECT_NEAR(errors.share_over_50mm, 0.2, kFloat);
    CellMask mask(7, 1, 1);
    mask.at(4, 0) = 0;
    const ElevationErrors masked = elevation_errors(live, truth, mask, {});
    EXPECT_EQ(masked.count, 4);
    EXPECT_EQ(masked.share_over_50mm, 0.0);
}

TEST(Maps, WithoutACommonCellThereIsNoFigure) {
    const ElevationErrors errors = elevation_errors(row({kNanF, 1}), row({1, kNanF}), {}, {});
    EXPECT_EQ(errors.count, 0);
    EXPECT_TRUE(std::isnan(errors.median_abs_m) && std::isnan(errors.share_over_50mm));
    EXPECT_TRUE(std::isnan(coverage(row({1, 1}), row({kNanF, kNanF}), {})));
}

TEST(Maps, CoverageCountsTheCellsOfTheMask) {
    const grid::Layer truth = row({0, 0, 0, 0, kNanF});
    const grid::Layer live = row({1, kNanF, 1, 1, 1});
    EXPECT_DOUBLE_EQ(coverage(live, truth, {}), 0.75);
    CellMask mask(5, 1, 0);
    mask.at(0, 0) = mask.at(1, 0) = mask.at(4, 0) = 1;
    EXPECT_DOUBLE_EQ(coverage(live, truth, mask), 0.5);
}

TEST(Maps, RadiusMaskTakesCellCentres) {
    const grid::GridGeometry geometry{1.0, 5, 5, {-2.5, -2.5}};
    const CellMask mask = within_radius(geometry, {0.0, 0.0}, 1.0);
    int set = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) set += mask.data()[i];
    EXPECT_EQ(set, 5);
    EXPECT_EQ(mask.at(2, 3), 1);
    EXPECT_EQ(both(mask, within_radius(geometry, {1.0, 0.0}, 0.5)).at(3, 2), 1);
    EXPECT_EQ(both(mask, within_radius(geometry, {1.0, 0.0}, 0.5)).at(2, 2), 0);
}

TEST(Maps, ConfusionOfASmallMap) {
    //                             safe-------------  unsafe----------------------  no truth
    const grid::Layer truth = row({1, .9F, .8F, .81F, .79F, 0, .5F, .2F, .3F, 0, kNanF});
    const grid::Layer live = row({1, .8F, .79F, kNanF, .80F, .9F, .1F, 0, 0, kNanF, 1});
    const Image<Call> calls = classify(live, truth, 0.80);
    using enum Call;
    const std::vector<Call> expected = {true_safe,
                                        true_safe,
                                        false_unsafe,
                                        unknown,
                                        false_safe,
                                        false_safe,
                                        true_unsafe,
                                        true_unsafe,
                                        true_unsafe,
                                        unknown,
                                        no_truth};
    for (int ix = 0; ix < 11; ++ix) EXPECT_EQ(calls.at(ix, 0), expected[std::size_t(ix)]) << ix;
    const TraversabilityErrors errors = traversability_errors(calls, {});
    EXPECT_DOUBLE_EQ(errors.false_safe, 2.0 / 5.0);
    EXPECT_DOUBLE_EQ(errors.true_unsafe, 3.0 / 5.0);
    EXPECT_DOUBLE_EQ(errors.false_unsafe, 1.0 / 3.0);
    EXPECT_DOUBLE_EQ(errors.true_safe, 2.0 / 3.0);
    EXPECT_DOUBLE_EQ(errors.unknown, 2.0 / 10.0);
    EXPECT_EQ(errors.truly_safe_cells, 3);
    EXPECT_EQ(errors.truly_unsafe_cells, 5);
    EXPECT_EQ(errors.unknown_cells, 2);
}

TEST(Maps, UnknownIsNeverCalledSafe) {
    Rng rng(7);
    grid::Layer live(40, 40), truth(40, 40);
    for (std::size_t i = 0; i < live.size(); ++i) {
        live.data()[i] = rng.uniform() < 0.3 ? kNanF : static_cast<float>(rng.uniform());
        truth.data()[i] = rng.uniform() < 0.3 ? kNanF : static_cast<float>(rng.uniform());
    }
    for (const double threshold : {0.0, 0.5, 1.0}) {
        const Image<Call> calls = classify(live, truth, threshold);
        for (std::size_t i = 0; i < live.size(); ++i) {
            const Call call = calls.data()[i];
            const bool safe = call == Call::true_safe || call == Call::false_safe;
            EXPECT_FALSE(safe && (std::isnan(live.data()[i]) || std::isnan(truth.data()[i])));
        }
    }
}

TEST(Maps, NothingUnsafeGivesNoFalseSafeFigure) {
    const TraversabilityErrors errors =
        traversability_errors(classify(row({1}), row({1}), 0.8), {});
    EXPECT_TRUE(std::isnan(errors.false_safe));
    EXPECT_EQ(errors.false_unsafe, 0.0);
}

}  // namespace
}  // namespace surefoot::eval
