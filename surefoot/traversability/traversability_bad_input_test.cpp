// SPDX-License-Identifier: Apache-2.0
// Invalid heights, discs that fit no map and invalid sizes must give an outcome or a message, and
// never a cell that is traversable by mistake. Shapes and poses of footprints: footprint_test; 1 x
// 1 maps and wide discs against the plain way: traversability_fast_test.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "surefoot/core/unknown.hpp"
#include "surefoot/traversability/footprint.hpp"
#include "surefoot/traversability/traversability.hpp"

namespace surefoot::traversability {
namespace {

constexpr double kResolution_m = 0.025;
constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr int kSide = 21;
constexpr int kMiddle = kSide / 2;

TraversabilityLayers rated(const grid::Layer& height_m, const TraversabilityConfig& config = {}) {
    TraversabilityLayers layers;
    rate(config, height_m.view(), kResolution_m, serial(), layers);
    return layers;
}

/// The default and every published set.
std::vector<TraversabilityConfig> all_configs() {
    std::vector<TraversabilityConfig> configs{TraversabilityConfig{}};
    for (const char* name : kPresetNames) configs.push_back(*preset(name));
    return configs;
}

void expect_ratings(const TraversabilityLayers& layers, const std::string& of) {
    for (const grid::Layer* layer :
         {&layers.slope, &layers.step, &layers.roughness, &layers.traversability}) {
        for (std::size_t i = 0; i < layer->size(); ++i) {
            const float rating = layer->data()[i];
            ASSERT_TRUE(std::isnan(rating) || (rating >= 0.0F && rating <= 1.0F)) << of << ' ' << i;
        }
    }
}

TEST(TraversabilityBadInput, OneHeightBeyondAllBoundsIsNeverTraversableNorBesideIt) {
    for (const TraversabilityConfig& config : all_configs()) {
        for (const float bad_m : {1e6F, -1e6F, 1e30F, -1e30F, 3e38F, -3e38F}) {
            grid::Layer height_m(kSide, kSide, 0.0F);
            height_m.at(kMiddle, kMiddle) = bad_m;
            const TraversabilityLayers layers = rated(height_m, config);
            expect_ratings(layers, std::to_string(bad_m));
            for (int dy = -1; dy <= 1; ++dy) {
                for (int dx = -1; dx <= 1; ++dx) {
                    EXPECT_FALSE(layers.traversability.at(kMiddle + dx, kMiddle + dy) >= 0.8F)
                        << bad_m << " at " << dx << ' ' << dy;
                }
            }
            EXPECT_EQ(layers.traversability.at(0, 0), 1.0F) << "far from it nothing changes";
        }
    }
}

TEST(TraversabilityBadInput, ACellOfUnknownHeightIsNeverTraversable) {
    for (const TraversabilityConfig& config : all_configs()) {
        for (const float bad_m : {kNanF, kInf, -kInf}) {
            grid::Layer height_m(kSide, kSide, 0.0F);
            height_m.at(kMiddle, kMiddle) = bad_m;
            const TraversabilityLayers layers = rated(height_m, config);
            EXPECT_FALSE(layers.traversability.at(kMiddle, kMiddle) > 0.0F) << bad_m;
            expect_ratings(layers, std::to_string(bad_m));
        }
    }
}

TEST(TraversabilityBadInput, DiscsSmallerThanACellRateNothingAndAreNamed) {
    TraversabilityConfig config;
    config.normals.radius_m = config.roughness.radius_m = 0.5 * kResolution_m;
    config.step.first_radius_m = config.step.second_radius_m = 0.5 * kResolution_m;
    const auto problem = config.problem(kResolution_m);
    ASSERT_TRUE(problem);
    EXPECT_NE(problem->find("less than the cell size"), std::string::npos) << *problem;
    // A caller that rates in spite of the problem gets no rating, and in particular no safe ground.
    const TraversabilityLayers layers = rated(grid::Layer(kSide, kSide, 0.0F), config);
    for (std::size_t i = 0; i < layers.traversability.size(); ++i) {
        ASSERT_FALSE(layers.traversability.data()[i] > 0.0F) << i;
    }
}

TEST(TraversabilityBadInput, DiscsWiderThanTheMapSeeAllOfItAndNoMore) {
    TraversabilityConfig config;
    config.normals.radius_m = config.roughness.radius_m = 5.0;
    config.step.first_radius_m = config.step.second_radius_m = 5.0;
    config.step.critical_cells = 1;
    grid::Layer height_m(5, 4, 0.0F);
    TraversabilityLayers layers = rated(height_m, config);
    EXPECT_EQ(layers.traversability.at(2, 2), 1.0F);
    height_m.at(4, 3) = 0.5F;
    layers = rated(height_m, config);
    for (std::size_t i = 0; i < layers.step.size(); ++i) EXPECT_EQ(layers.step.data()[i], 0.0F);
}

TEST(TraversabilityBadInput, SizesThatAreNoneAreNamed) {
    TraversabilityConfig config;
    for (const double bad_m : {0.0, -0.08, static_cast<double>(kNanF)}) {
        for (double* radius_m :
             {&config.normals.radius_m, &config.step.first_radius_m, &config.roughness.radius_m}) {
            const double good_m = *radius_m;
            *radius_m = bad_m;
            const auto problem = config.problem(kResolution_m);
            ASSERT_TRUE(problem) << bad_m;
            EXPECT_NE(problem->find("radius_m"), std::string::npos) << *problem;
            *radius_m = good_m;
        }
    }
    ASSERT_FALSE(config.problem(kResolution_m));
    for (const double bad_m : {0.0, -0.025, static_cast<double>(kNanF)}) {
        const auto problem = config.problem(bad_m);
        ASSERT_TRUE(problem) << "cells of " << bad_m << " m";
        EXPECT_NE(problem->find("cell"), std::string::npos) << *problem;
    }
    config.weights.step = static_cast<double>(kNanF);
    EXPECT_TRUE(config.problem(kResolution_m)) << "a weight of NaN";
}

TEST(TraversabilityBadInput, ChangesThatLieNowhereChangeNothing) {
    grid::Layer height_m(kSide, kSide, 0.0F);
    Traversability rater{TraversabilityConfig{}};
    TraversabilityLayers layers;
    rater.rate(height_m.view(), kResolution_m, serial(), layers);
    height_m.fill(kNanF);
    for (const CellRect& rect : {CellRect{0, 0, 0, 0},
                                 CellRect{5, 5, -3, 4},
                                 CellRect{100, 100, 5, 5},
                                 CellRect{-50, -50, 10, 10}}) {
        rater.rate(height_m.view(), kResolution_m, rect, serial(), layers);
        EXPECT_EQ(layers.traversability.at(kMiddle, kMiddle), 1.0F);
    }
    rater.rate(height_m.view(), kResolution_m, {-5, -5, 1000, 1000}, serial(), layers);
    EXPECT_TRUE(std::isnan(layers.traversability.at(kMiddle, kMiddle)));
}

TEST(TraversabilityBadInput, AFootprintOnRatingsThatAreNoneIsNotTraversable) {
    const auto foot = Footprint::circle(0.1);
    ASSERT_TRUE(foot.ok());
    const grid::Layer height_m(kSide, kSide, 0.0F);
    const grid::GridGeometry geometry{kResolution_m, kSide, kSide, {-0.2625, -0.2625}};
    for (const float bad : {kNanF, kInf, -kInf, -1.0F, 0.0F}) {
        grid::Layer rating(kSide, kSide, 1.0F);
        EXPECT_TRUE(
            is_traversable(query(*foot, {}, {geometry, rating.view(), height_m.view()}), 0.8));
        rating.at(kMiddle, kMiddle) = bad;
        const FootprintReport report = query(*foot, {}, {geometry, rating.view(), height_m.view()});
        EXPECT_EQ(report.outcome, FootprintOutcome::rated) << bad;
        EXPECT_FALSE(is_traversable(report, 0.8)) << bad;
    }
}

}  // namespace
}  // namespace surefoot::traversability
