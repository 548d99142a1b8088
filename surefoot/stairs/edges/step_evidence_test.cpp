// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/edges/step_evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "surefoot/stairs/feature_finder.hpp"
#include "surefoot/stairs/smooth_ground_testing.hpp"
#include "surefoot/stairs/terrain_testing.hpp"

namespace surefoot::stairs {
namespace {

using testing::Ground;
using testing::height_errors;
using testing::SmoothGround;
using testing::SmoothMap;
using testing::TestFlight;
using testing::TestMap;

const double kStep = std::log(StairsConfig{}.step_ratio);

TerrainFeatures find(const Terrain& terrain) {
    FeatureFinder finder{StairsConfig{}};
    TerrainFeatures found;
    finder.find(terrain, found);
    return found;
}

/// The line x = 0 of a map, 1 m long; the lower ground is at smaller x.
Edge line_at_0(double upper_m, double lower_m) {
    Edge edge;
    edge.from_m = {0.0, 0.5};
    edge.to_m = {0.0, -0.5};
    edge.upper_m = upper_m;
    edge.lower_m = lower_m;
    edge.lower_seen = true;
    if (edge.down().x() > 0.0) std::swap(edge.from_m, edge.to_m);
    return edge;
}

double log_ratio(const Terrain& terrain, double height_m) {
    StepEvidenceFinder finder{StairsConfig{}};
    return finder.weigh(terrain, line_at_0(height_m, 0.0), 0.35, 0.35).log_ratio;
}

void add_errors(double sigma_m, double correlation_m, std::uint64_t seed, TestMap& map) {
    const grid::Layer errors_m =
        height_errors(map.geometry.nx, map.geometry.resolution_m, sigma_m, correlation_m, seed);
    for (std::size_t i = 0; i < errors_m.size(); ++i) map.height_m.data()[i] += errors_m.data()[i];
}

TEST(StepEvidence, SmoothGroundOfAnySlopeHasNeitherFlightsNorKerbs) {
    struct Errors {
        double sigma_m;
        double correlation_m;
        bool stated;
    };
    constexpr Errors kErrors[] = {
        {0.0, 0.0, false}, {0.012, 0.0, false}, {0.008, 0.1, true}, {0.012, 0.1, false}};
    constexpr std::uint64_t kFirstSeed = 501;
    for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + 25; ++seed) {
        const SmoothGround ground(seed);
        for (const Errors& errors : kErrors) {
            const SmoothMap map(ground, errors.sigma_m, errors.correlation_m, errors.stated, seed);
            const TerrainFeatures found = find(map.terrain());
            const auto where = ::testing::Message() << "seed " << seed << ", " << ground.slope_deg
                                                    << " deg, " << 1e3 * errors.sigma_m << " mm";
            EXPECT_TRUE(found.flights.empty()) << where;
            EXPECT_TRUE(found.kerbs.empty()) << where;
        }
    }
}

// In slices of one cell such slopes resemble treads and risers.
TEST(StepEvidence, ASlopeFromALevelFloorOnIsNoStair) {
    for (const double slope_deg : {12.0, 18.0, 22.0, 26.0, 30.0, 35.0}) {
        for (const double yaw_deg : {0.0, 20.0}) {
            const Ground slope = [&](double x_m, double) {
                return std::max(0.0, x_m - 0.8) * std::tan(slope_deg * kRadPerDeg);
            };
            for (const double sigma_m : {0.0, 0.012}) {
                TestMap map(slope, yaw_deg * kRadPerDeg, {0.0, 0.0});
                if (sigma_m > 0.0) map.add_noise(sigma_m, 11);
                map.var_m2.fill(0.0F);  // a grid without stated variances
                const TerrainFeatures found = find(map.terrain({0.0, 0.0}));
                const auto where = ::testing::Message() << slope_deg << " deg, turned by "
                                                        << yaw_deg << " deg, " << sigma_m << " m";
                EXPECT_TRUE(found.flights.empty()) << where;
                EXPECT_TRUE(found.kerbs.empty()) << where;
            }
        }
    }
}

TEST(StepEvidence, AKerbBeforeASlopeIsOneStepAndNoFlight) {
    const Ground ground = [](double x_m, double) {
        return x_m < 0.3 ? 0.0 : 0.12 + (x_m - 0.3) * std::tan(24.0 * kRadPerDeg);
    };
    const TestMap map(ground, 0.2, {0.0, 0.0});
    const TerrainFeatures found = find(map.terrain({-0.5, 0.0}));
    ASSERT_EQ(found.kerbs.size(), 1U);
    EXPECT_NEAR(map.to_world(found.kerbs[0].pose.p_m.head<2>()).x(), 0.3, 0.03);
    for (const Flight& flight : found.flights) EXPECT_EQ(flight.steps, 1);
}

TEST(StepEvidence, ALowKerbStandsOutOfTheErrorsOfItsCells) {
    // A kerb of 75 mm, smeared over 0.1 m as by a matcher.
    const TestMap exact(
        [](double x_m, double) { return 0.075 * std::clamp(10.0 * x_m + 0.5, 0.0, 1.0); },
        0.0,
        {0.0, 0.0});
    struct Errors {
        double sigma_m;
        double correlation_m;
    };
    for (const Errors& errors : {Errors{0.012, 0.0}, Errors{0.008, 0.1}}) {
        for (std::uint64_t seed = 1; seed <= 10; ++seed) {
            TestMap map = exact;
            add_errors(errors.sigma_m, errors.correlation_m, seed, map);
            EXPECT_GE(log_ratio(map.terrain(), 0.075), kStep)
                << "seed " << seed << ", " << errors.sigma_m << " m that hang together over "
                << errors.correlation_m << " m";
        }
    }
}

TEST(StepEvidence, ErrorsThatHangTogetherCountAsFewerCells) {
    const TestMap exact([](double x_m, double) { return x_m < 0.0 ? 0.0 : 0.1; }, 0.0, {0, 0});
    const auto mean_ratio = [&](double correlation_m) {
        constexpr std::uint64_t kSeeds = 10;
        double sum = 0.0;
        for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
            TestMap map = exact;
            add_errors(0.03, correlation_m, seed, map);
            sum += log_ratio(map.terrain(), 0.1);
        }
        return sum / static_cast<double>(kSeeds);
    };
    EXPECT_LT(mean_ratio(0.1), 0.5 * mean_ratio(0.0)) << "25 cells of one error are not 25 errors";
}

TEST(StepEvidence, KerbsOnACrossFallOrAgainstAWallAreSteps) {
    const TestMap cross_fall(
        [](double x_m, double y_m) { return (x_m < 0.0 ? 0.0 : 0.1) + 0.1 * y_m; }, 0.0, {0, 0});
    EXPECT_GE(log_ratio(cross_fall.terrain(), 0.1), kStep);
    const TestMap walled(
        [](double x_m, double y_m) { return y_m > 0.4   ? 1.6
                                            : x_m < 0.0 ? 0.0
                                                        : 0.1; },
        0.0,
        {0, 0});
    EXPECT_GE(log_ratio(walled.terrain(), 0.1), kStep);
    const TestMap slope([](double x_m, double) { return 0.5 * x_m; }, 0.0, {0, 0});
    EXPECT_LT(log_ratio(slope.terrain(), 0.1), 0.0);
}

TEST(StepEvidence, WhatIsNotKnownIsNotAsked) {
    TestMap map([](double x_m, double) { return x_m < 0.0 ? 0.0 : 0.1; }, 0.0, {0.0, 0.0});
    for (int iy = 0; iy < map.geometry.ny; ++iy)
        for (int ix = 0; ix < map.geometry.nx; ++ix)
            if (map.geometry.center_m({ix, iy}).x() < 0.0) map.height_m.at(ix, iy) = std::nanf("");
    EXPECT_TRUE(std::isnan(log_ratio(map.terrain(), 0.1)));
    EXPECT_TRUE(std::isnan(log_ratio(Terrain{}, 0.1)));
}

TEST(StepEvidence, ARatioOfZeroAsksNothing) {
    StairsConfig config;
    config.step_ratio = config.drop_ratio = 0.0;
    ASSERT_FALSE(config.problem());
    Edge edge;
    EXPECT_TRUE(is_step_of(config, edge));
    config.step_ratio = 10.0;
    EXPECT_FALSE(is_step_of(config, edge)) << "not asked is not proven";
    edge.log_step_ratio = std::log(11.0);
    EXPECT_TRUE(is_step_of(config, edge));
    config.drop_ratio = 20.0;
    EXPECT_TRUE(config.problem()) << "a step down is a drop";
}

}  // namespace
}  // namespace surefoot::stairs
