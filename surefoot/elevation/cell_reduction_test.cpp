// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/cell_reduction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "surefoot/core/rng.hpp"

namespace surefoot::elevation {
namespace {

constexpr float kVar = 2.5e-5F;  // (5 mm)^2

void add_surface(std::vector<HeightSample>& samples, Rng& rng, int count, double z_m) {
    for (int i = 0; i < count; ++i) {
        samples.push_back({static_cast<float>(z_m + 0.005 * rng.normal()), kVar});
    }
}

TEST(CellReduction, NothingFromFewerPointsThanAsked) {
    std::vector<HeightSample> samples;
    EXPECT_FALSE(reduce_cell({}, samples));
    for (int min_points = 2; min_points <= 4; ++min_points) {
        ReductionConfig config;
        config.min_points = min_points;
        samples.assign(static_cast<std::size_t>(min_points) - 1, {0.1F, kVar});
        EXPECT_FALSE(reduce_cell(config, samples)) << min_points;
        samples.push_back({0.5F, kVar});
        EXPECT_FALSE(reduce_cell(config, samples)) << "points that disagree, " << min_points;
        samples.assign(static_cast<std::size_t>(min_points), {0.1F, kVar});
        const auto measured = reduce_cell(config, samples);
        ASSERT_TRUE(measured);
        EXPECT_EQ(measured->z_m, 0.1F);
        EXPECT_EQ(measured->points, min_points);
    }
}

TEST(CellReduction, FloorIsUnbiasedAndItsVarianceIsNotLowered) {
    Rng rng(1);
    const ReductionConfig config;
    double sum_m = 0.0;
    constexpr int kCells = 2000;
    for (int cell = 0; cell < kCells; ++cell) {
        std::vector<HeightSample> samples;
        add_surface(samples, rng, 60, 0.0);
        const auto measured = reduce_cell(config, samples);
        ASSERT_TRUE(measured);
        sum_m += static_cast<double>(measured->z_m);
        EXPECT_GE(measured->var_m2, kVar) << "60 pixels of one frame share their error";
    }
    // The mean over cells is known to 5 mm / sqrt(60 * 2000) = 0.015 mm; mean shift leaves less
    // than a tenth of a millimetre of the upper start.
    EXPECT_NEAR(sum_m / kCells, 0.0, 1e-4);
}

TEST(CellReduction, UpperOfTwoSurfacesWins) {
    Rng rng(2);
    for (const int upper : {8, 20, 40}) {
        std::vector<HeightSample> samples;
        add_surface(samples, rng, 50 - upper, 0.0);
        add_surface(samples, rng, upper, 0.18);
        const auto measured = reduce_cell({}, samples);
        ASSERT_TRUE(measured);
        EXPECT_NEAR(measured->z_m, 0.18F, 0.006F) << upper << " of 50 points on the tread";
        EXPECT_NEAR(measured->lowest_m, 0.0F, 0.015F);
    }
}

TEST(CellReduction, TreadWinsOverTheRiserBelowIt) {
    Rng rng(3);
    std::vector<HeightSample> samples;
    add_surface(samples, rng, 20, 0.18);
    for (int i = 0; i < 40; ++i)
        samples.push_back({static_cast<float>(rng.uniform(0.0, 0.18)), kVar});
    const auto measured = reduce_cell({}, samples);
    ASSERT_TRUE(measured);
    // The top 2 * 22 mm of the riser, 5 points, pull 20 points down by at most 22 mm * 5 / 25.
    EXPECT_NEAR(measured->z_m, 0.18F, 0.006F);
}

TEST(CellReduction, SingleOutliersDoNotWin) {
    Rng rng(4);
    std::vector<HeightSample> samples;
    add_surface(samples, rng, 30, 0.0);
    samples.push_back({0.9F, kVar});
    samples.push_back({0.5F, kVar});
    samples.push_back({0.7F, kVar});
    samples.push_back({0.3F, kVar});
    const auto measured = reduce_cell({}, samples);
    ASSERT_TRUE(measured);
    EXPECT_NEAR(measured->z_m, 0.0F, 0.005F);
    samples = {{0.0F, kVar}, {0.9F, kVar}, {0.002F, kVar}};
    ReductionConfig pairs;
    pairs.min_points = 2;
    ASSERT_TRUE(reduce_cell(pairs, samples));
    EXPECT_NEAR(reduce_cell(pairs, samples)->z_m, 0.001F, 1e-6F);
}

TEST(CellReduction, VarianceFollowsTheIndependentPointsAndTheScatter) {
    ReductionConfig config;
    config.points_per_independent = 4.0;
    config.max_independent = 3.0;
    config.systematic_sigma_m = 0.002;
    std::vector<HeightSample> samples(8, {0.0F, kVar});
    EXPECT_NEAR(reduce_cell(config, samples)->var_m2, 2.5e-5 / 2.0 + 4e-6, 1e-11);
    samples.assign(100, {0.0F, kVar});
    EXPECT_NEAR(reduce_cell(config, samples)->var_m2, 2.5e-5 / 3.0 + 4e-6, 1e-11);
    // Points that scatter more than they claim: alternating +-5 mm around 0.
    for (std::size_t i = 0; i < samples.size(); ++i)
        samples[i] = {i % 2 == 0 ? 0.005F : -0.005F, 1e-6F};
    EXPECT_NEAR(reduce_cell(config, samples)->var_m2, 2.5e-5 * 100.0 / 99.0 / 3.0 + 4e-6, 1e-9);
}

TEST(CellReduction, GroupsMatchAMapOfCells) {
    Rng rng(6);
    grid::GridGeometry geometry;
    geometry.resolution_m = 0.125;  // exact in binary: both ways of finding the cell agree
    geometry.nx = 7;
    geometry.ny = 5;
    CellGroups groups;
    for (int round = 0; round < 20; ++round) {
        std::vector<GridPoint> points;
        std::map<std::size_t, std::vector<float>> truth;
        std::int64_t outside = 0;
        for (int i = 0; i < 300; ++i) {
            const GridPoint point{static_cast<float>(rng.uniform(-0.2, 1.0)),
                                  static_cast<float>(rng.uniform(-0.2, 0.8)),
                                  static_cast<float>(i),
                                  kVar};
            points.push_back(point);
            const auto cell =
                geometry.cell_at(static_cast<double>(point.x_m), static_cast<double>(point.y_m));
            if (cell) {
                truth[static_cast<std::size_t>(cell->iy * geometry.nx + cell->ix)].push_back(
                    point.z_m);
            } else {
                ++outside;
            }
        }
        points.push_back({std::numeric_limits<float>::quiet_NaN(), 0.1F, 0.0F, kVar});
        EXPECT_EQ(groups.assign(points, geometry), outside + 1);
        for (std::size_t cell = 0; cell < 35; ++cell) {
            std::vector<float> heights;
            for (const HeightSample& sample : groups.samples(cell)) heights.push_back(sample.z_m);
            EXPECT_EQ(heights, truth[cell]) << "cell " << cell << " round " << round;
        }
    }
}

}  // namespace
}  // namespace surefoot::elevation
