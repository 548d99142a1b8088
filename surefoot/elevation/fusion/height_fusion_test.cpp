// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/height_fusion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "surefoot/core/rng.hpp"

namespace surefoot::elevation {
namespace {

TEST(HeightFusion, AgreesWithEquation61) {
    // h+ = (4e-4 * 0 + 1e-4 * 0.01) / 5e-4 = 2 mm, s2+ = 1e-4 * 4e-4 / 5e-4 = 0.8e-4.
    const FusionResult result = fuse({}, {0.0, 1e-4}, {0.01, 4e-4});
    EXPECT_EQ(result.outcome, FusionOutcome::fused);
    EXPECT_NEAR(result.cell.z_m, 0.002, 1e-15);
    EXPECT_NEAR(result.cell.var_m2, 0.8e-4, 1e-15);
}

TEST(HeightFusion, ManyMeasurementsApproachTheWeightedMeanOfAllOfThem) {
    Rng rng(3);
    FusionConfig config;
    config.gate_sigma = 100.0;  // nothing is gated: pure recursive least squares
    config.min_height_var_m2 = 1e-12;
    Height cell{0.3, 4e-4};
    double weight = 1.0 / cell.var_m2;
    double weighted_m = cell.z_m * weight;
    for (int k = 0; k < 200; ++k) {
        const Height measured{0.3 + 0.02 * rng.normal(), rng.uniform(1e-4, 9e-4)};
        cell = fuse(config, cell, measured).cell;
        weight += 1.0 / measured.var_m2;
        weighted_m += measured.z_m / measured.var_m2;
    }
    EXPECT_NEAR(cell.z_m, weighted_m / weight, 1e-12);
    EXPECT_NEAR(cell.var_m2, 1.0 / weight, 1e-15);
}

TEST(HeightFusion, GateUsesCellAndMeasurementVariance) {
    const Height cell{0.0, 9e-6};          // 3 mm
    const Height measured{0.012, 1.6e-5};  // 4 mm: innovation sigma 5 mm, distance 2.4 sigma
    EXPECT_NEAR(mahalanobis_sq(cell, measured), 2.4 * 2.4, 1e-12);
    EXPECT_EQ(fuse({}, cell, measured).outcome, FusionOutcome::fused);
    EXPECT_EQ(fuse({}, cell, {0.013, 1.6e-5}).outcome, FusionOutcome::inflated);

    FusionConfig reference;  // with the cell's variance only, the distance is 4 sigma
    reference.gate_variance = GateVariance::cell_alone;
    EXPECT_EQ(fuse(reference, cell, measured).outcome, FusionOutcome::inflated);
}

TEST(HeightFusion, DisagreementCostsTrustNotHeight) {
    const FusionConfig config;
    const FusionResult result = fuse(config, {0.1, 1e-4}, {0.3, 1e-5});
    EXPECT_EQ(result.outcome, FusionOutcome::inflated);
    EXPECT_EQ(result.cell.z_m, 0.1);
    EXPECT_DOUBLE_EQ(result.cell.var_m2, 1e-4 + config.multi_height_var_m2);
}

TEST(HeightFusion, OneWrongMatchSaysLittleAgainstASureCellTheNextOnesMore) {
    const FusionConfig config;
    const Height wrong{0.3, 1e-5};
    Height cell{0.1, 1e-5};
    std::vector<double> sigma_mm;
    for (int k = 0; k < 3; ++k) {
        cell = fuse(config, cell, wrong).cell;
        sigma_mm.push_back(1e3 * std::sqrt(cell.var_m2));
    }
    EXPECT_NEAR(sigma_mm[0], 2.0 * std::sqrt(10.0), 1e-9);  // twice the value before
    EXPECT_NEAR(sigma_mm[1], std::sqrt(40.0 + 100.0), 1e-9);
    EXPECT_NEAR(sigma_mm[2], std::sqrt(40.0 + 200.0), 1e-9);
    EXPECT_EQ(cell.z_m, 0.1);
}

TEST(HeightFusion, ATailOfTheNoiseCostsNoMoreTrustThanItAsksFor) {
    const FusionConfig config;
    const Height cell{0.1, 4e-5};
    const double measured_m2 = 4e-5;
    const double sigma_m = std::sqrt(cell.var_m2 + measured_m2);
    double last_m2 = cell.var_m2;
    for (const double sigmas : {2.51, 2.7, 3.0, 3.5, 6.0}) {
        for (const double sign : {1.0, -1.0}) {
            const Height measured{cell.z_m + sign * sigmas * sigma_m, measured_m2};
            const FusionResult result = fuse(config, cell, measured);
            ASSERT_EQ(result.outcome, FusionOutcome::inflated);
            EXPECT_EQ(result.cell.z_m, cell.z_m);
            EXPECT_GE(result.cell.var_m2, last_m2);
            if (sigmas < 3.5) {  // now the same measurement lies on the gate
                EXPECT_NEAR(mahalanobis_sq(result.cell, measured),
                            config.gate_sigma * config.gate_sigma,
                            1e-9);
            } else {
                EXPECT_LE(result.cell.var_m2, cell.var_m2 + config.multi_height_var_m2);
            }
            if (sign < 0.0) last_m2 = result.cell.var_m2;
        }
    }
    EXPECT_DOUBLE_EQ(last_m2, cell.var_m2 + config.multi_height_var_m2);
}

TEST(HeightFusion, AChangedSceneTakesOverAfterSomeCycles) {
    const FusionConfig config;
    // Each contradiction except the first adds (10 mm)^2; beyond (50 mm)^2 the cell is replaced: at
    // most 25 + 1 frames.
    const int limit =
        static_cast<int>(std::ceil(config.max_height_var_m2 / config.multi_height_var_m2)) + 1;
    for (const double change_m : {-1.0, -0.18, 0.1, 0.5}) {
        Height cell{0.0, 1e-5};
        int frames = 0;
        while (std::abs(cell.z_m - change_m) > 0.01 && frames < 1000) {
            cell = fuse(config, cell, {change_m, 2e-5}).cell;
            ++frames;
        }
        EXPECT_GT(frames, 3) << "change " << change_m;
        EXPECT_LE(frames, limit) << "change " << change_m;
    }
}

TEST(HeightFusion, WithinOneScanTheUpperSurfaceStays) {
    const FusionConfig config;
    const Height cell{0.1, 1e-5};
    EXPECT_EQ(fuse(config, cell, {0.0, 1e-5}, true).outcome, FusionOutcome::ignored);
    EXPECT_EQ(fuse(config, cell, {0.0, 1e-5}, true).cell.var_m2, cell.var_m2);
    const FusionResult higher = fuse(config, cell, {0.2, 3e-5}, true);
    EXPECT_EQ(higher.outcome, FusionOutcome::replaced);
    EXPECT_EQ(higher.cell.z_m, 0.2);
    EXPECT_EQ(higher.cell.var_m2, 3e-5);
}

TEST(HeightFusion, VarianceStaysWithinItsBounds) {
    const FusionConfig config;
    Height cell{0.0, 1e-4};
    for (int k = 0; k < 100; ++k) cell = fuse(config, cell, {0.0, 1e-5}).cell;
    EXPECT_DOUBLE_EQ(cell.var_m2, config.min_height_var_m2);
}

TEST(HeightFusion, ConfigurationProblemsNameTheKeyAndTheValue) {
    FusionConfig config;
    EXPECT_FALSE(config.problem());
    config.min_height_var_m2 = 1.0;
    ASSERT_TRUE(config.problem());
    EXPECT_NE(config.problem()->find("elevation.min_height_var_m2 = 1 "), std::string::npos)
        << *config.problem();
    config = {};
    config.gate_sigma = NAN;
    EXPECT_TRUE(config.problem());
    config = {};
    config.contradiction_growth = 1.0;
    EXPECT_TRUE(config.problem());
}

}  // namespace
}  // namespace surefoot::elevation
