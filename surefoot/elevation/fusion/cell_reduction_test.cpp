// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/cell_reduction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "surefoot/core/rng.hpp"

namespace surefoot::elevation {
namespace {

constexpr float kVar = 2.5e-5F;  // (5 mm)^2

struct HeightSample {
    float z_m = 0.0F;
    float var_m2 = 0.0F;
};

std::optional<CellMeasurement> reduce(const ReductionConfig& config,
                                      const std::vector<HeightSample>& samples) {
    std::vector<float> z_m;
    std::vector<float> var_m2;
    for (const HeightSample& sample : samples) {
        z_m.push_back(sample.z_m);
        var_m2.push_back(sample.var_m2);
    }
    return reduce_cell(config, z_m, var_m2);
}

void add_surface(std::vector<HeightSample>& samples, Rng& rng, int count, double z_m) {
    for (int i = 0; i < count; ++i) {
        samples.push_back({static_cast<float>(z_m + 0.005 * rng.normal()), kVar});
    }
}

TEST(CellReduction, NothingFromFewerPointsThanAsked) {
    std::vector<HeightSample> samples;
    EXPECT_FALSE(reduce({}, samples));
    for (int min_points = 2; min_points <= 4; ++min_points) {
        ReductionConfig config;
        config.min_points = min_points;
        samples.assign(static_cast<std::size_t>(min_points) - 1, {0.1F, kVar});
        EXPECT_FALSE(reduce(config, samples)) << min_points;
        samples.push_back({0.5F, kVar});
        EXPECT_FALSE(reduce(config, samples)) << "points that disagree, " << min_points;
        samples.assign(static_cast<std::size_t>(min_points), {0.1F, kVar});
        const auto measured = reduce(config, samples);
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
        const auto measured = reduce(config, samples);
        ASSERT_TRUE(measured);
        sum_m += static_cast<double>(measured->z_m);
        EXPECT_GE(measured->var_m2, kVar) << "60 pixels of one frame share their error";
    }
    // The standard error of the mean over cells is 5 mm / sqrt(60 * 2000) = 0.015 mm. Mean shift
    // keeps less than a tenth of a millimetre of its upper start.
    EXPECT_NEAR(sum_m / kCells, 0.0, 1e-4);
}

TEST(CellReduction, UpperOfTwoSurfacesWins) {
    Rng rng(2);
    for (const int upper : {8, 20, 40}) {
        std::vector<HeightSample> samples;
        add_surface(samples, rng, 50 - upper, 0.0);
        add_surface(samples, rng, upper, 0.18);
        const auto measured = reduce({}, samples);
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
    const auto measured = reduce({}, samples);
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
    const auto measured = reduce({}, samples);
    ASSERT_TRUE(measured);
    EXPECT_NEAR(measured->z_m, 0.0F, 0.005F);
    samples = {{0.0F, kVar}, {0.9F, kVar}, {0.002F, kVar}};
    ReductionConfig pairs;
    pairs.min_points = 2;
    ASSERT_TRUE(reduce(pairs, samples));
    EXPECT_NEAR(reduce(pairs, samples)->z_m, 0.001F, 1e-6F);
}

TEST(CellReduction, AFaceSeenFromTheSideHasTheHeightOfItsTop) {
    Rng rng(5);
    std::vector<HeightSample> samples;
    for (int i = 0; i < 400; ++i)
        samples.push_back({static_cast<float>(rng.uniform(0.0, 0.9)), kVar});
    const auto measured = reduce({}, samples);
    ASSERT_TRUE(measured) << "a wall is no floor";
    // A tenth of the points, 40 of 400, lies above.
    EXPECT_NEAR(measured->z_m, 0.81F, 0.05F);
    EXPECT_GT(std::sqrt(measured->var_m2), 0.01F);
    EXPECT_EQ(measured->points, 400);
    // A few scattered points are noise.
    samples.resize(20);
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i].z_m = 0.05F * static_cast<float>(i);
    EXPECT_FALSE(reduce({}, samples));
}

TEST(CellReduction, VarianceFollowsTheIndependentPointsAndTheScatter) {
    ReductionConfig config;
    config.points_per_independent = 4.0;
    config.max_independent = 3.0;
    config.systematic_sigma_m = 0.002;
    std::vector<HeightSample> samples(8, {0.0F, kVar});
    EXPECT_NEAR(reduce(config, samples)->var_m2, 2.5e-5 / 2.0 + 4e-6, 1e-11);
    samples.assign(100, {0.0F, kVar});
    EXPECT_NEAR(reduce(config, samples)->var_m2, 2.5e-5 / 3.0 + 4e-6, 1e-11);
    // Points with more scatter than their variance states: alternating +-5 mm around 0.
    for (std::size_t i = 0; i < samples.size(); ++i)
        samples[i] = {i % 2 == 0 ? 0.005F : -0.005F, 1e-6F};
    EXPECT_NEAR(reduce(config, samples)->var_m2, 2.5e-5 * 100.0 / 99.0 / 3.0 + 4e-6, 1e-9);
}

}  // namespace
}  // namespace surefoot::elevation
