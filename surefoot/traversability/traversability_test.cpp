// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/traversability.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::traversability {
namespace {

constexpr double kResolution_m = 0.025;
constexpr float kRounding = 1e-6F;  // ratings are float, a few roundings of 6e-8

/// Height map as literal text: numbers are centimetres, `?` is unknown, the first line has the
/// largest y.
grid::Layer map_cm(const std::string& text) {
    std::vector<std::vector<float>> rows;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::vector<float> row;
        for (std::string word; words >> word;) {
            row.push_back(word == "?" ? kNanF : 0.01F * std::stof(word));
        }
        if (!row.empty()) rows.insert(rows.begin(), row);
    }
    if (rows.empty()) return {};
    grid::Layer map(static_cast<int>(rows.front().size()), static_cast<int>(rows.size()));
    for (int iy = 0; iy < map.height(); ++iy) {
        for (int ix = 0; ix < map.width(); ++ix) {
            map.at(ix, iy) = rows[static_cast<std::size_t>(iy)][static_cast<std::size_t>(ix)];
        }
    }
    return map;
}

template <typename Height>
grid::Layer map_of(int nx, int ny, const Height& height_m) {
    grid::Layer map(nx, ny);
    for (int iy = 0; iy < ny; ++iy) {
        for (int ix = 0; ix < nx; ++ix) {
            map.at(ix, iy) = static_cast<float>(height_m(ix * kResolution_m, iy * kResolution_m));
        }
    }
    return map;
}

/// Floor, ramp, block, noise and 10 % holes.
grid::Layer rough_scene(int nx, int ny, std::uint64_t seed) {
    Rng rng(seed);
    return map_of(nx, ny, [&](double x, double y) {
        const double noise_m = 0.003 * rng.normal();
        if (rng.uniform() < 0.1) return std::numeric_limits<double>::quiet_NaN();
        if (x > 0.6 && y > 0.4) return 0.15 + noise_m;
        return (x < 0.3 ? 0.3 * y : 0.0) + noise_m;
    });
}

TraversabilityLayers rated(const grid::Layer& map, const TraversabilityConfig& config = {}) {
    Serial serial;
    TraversabilityLayers layers;
    rate(config, map.view(), kResolution_m, serial, layers);
    return layers;
}

std::vector<const grid::Layer*> all(const TraversabilityLayers& layers) {
    return {&layers.normal_x,
            &layers.normal_y,
            &layers.normal_z,
            &layers.slope,
            &layers.step,
            &layers.roughness,
            &layers.traversability};
}

bool same(float a, float b) {
    return (std::isnan(a) && std::isnan(b)) || a == b;
}

/// Cells in which any layer differs (NaN equals NaN).
int differing_cells(const TraversabilityLayers& a, const TraversabilityLayers& b) {
    int count = 0;
    for (int iy = 0; iy < a.slope.height(); ++iy) {
        for (int ix = 0; ix < a.slope.width(); ++ix) {
            bool equal = true;
            for (std::size_t i = 0; i < all(a).size(); ++i) {
                equal = equal && same(all(a)[i]->at(ix, iy), all(b)[i]->at(ix, iy));
            }
            count += equal ? 0 : 1;
        }
    }
    return count;
}

/// Runs the work items in reverse order and reports many threads.
class Reverse final : public Executor {
  public:
    void parallel_for(int count, const std::function<void(int)>& work) override {
        for (int index = count - 1; index >= 0; --index) work(index);
    }
};

TEST(Traversability, EmptyMapHasEmptyLayers) {
    const TraversabilityLayers layers = rated(grid::Layer{});
    EXPECT_TRUE(layers.traversability.empty());
}

TEST(Traversability, UnknownMapStaysUnknown) {
    const TraversabilityLayers layers = rated(map_cm("? ? ?\n? ? ?"));
    for (const grid::Layer* layer : all(layers)) {
        for (std::size_t i = 0; i < layer->size(); ++i) EXPECT_TRUE(std::isnan(layer->data()[i]));
    }
}

TEST(Traversability, InfiniteHeightsAreUnknown) {
    const float infinity = std::numeric_limits<float>::infinity();
    const TraversabilityLayers layers = rated(grid::Layer(3, 3, infinity));
    EXPECT_TRUE(std::isnan(layers.traversability.at(1, 1)));
}

TEST(Traversability, LoneCellIsNotSmooth) {
    for (const char* text : {"7", "? ? ?\n? 7 ?\n? ? ?"}) {
        const grid::Layer map = map_cm(text);
        const int c = map.width() / 2;
        const TraversabilityLayers layers = rated(map);
        EXPECT_EQ(layers.normal_z.at(c, c), 1.0F) << "too few points for a plane: +z";
        EXPECT_EQ(layers.slope.at(c, c), 1.0F);
        EXPECT_EQ(layers.step.at(c, c), 1.0F);
        EXPECT_EQ(layers.roughness.at(c, c), 0.0F);
        EXPECT_NEAR(layers.traversability.at(c, c), 2.0F / 3.0F, kRounding);

        TraversabilityConfig config;
        config.combine = Combine::zero_dominates;
        EXPECT_EQ(rated(map, config).traversability.at(c, c), 0.0F);
    }
}

TEST(Traversability, FlatGroundIsExactlyOneAtAnyHeight) {
    for (const float height_m : {0.0F, -0.5F, 123.456F}) {
        const TraversabilityLayers layers = rated(grid::Layer(12, 9, height_m));
        for (int iy = 0; iy < 9; ++iy) {
            for (int ix = 0; ix < 12; ++ix) {
                ASSERT_EQ(layers.normal_z.at(ix, iy), 1.0F) << height_m << ' ' << ix << ' ' << iy;
                ASSERT_EQ(layers.slope.at(ix, iy), 1.0F) << height_m << ' ' << ix << ' ' << iy;
                ASSERT_EQ(layers.step.at(ix, iy), 1.0F) << height_m << ' ' << ix << ' ' << iy;
                ASSERT_EQ(layers.roughness.at(ix, iy), 1.0F) << height_m << ' ' << ix << ' ' << iy;
                ASSERT_NEAR(layers.traversability.at(ix, iy), 1.0F, kRounding);
            }
        }
    }
}

TEST(Traversability, RampHasItsAnglesNormalAndNoRoughness) {
    constexpr double kSlopeX = 0.15;
    constexpr double kSlopeY = -0.10;
    const grid::Layer map =
        map_of(20, 20, [](double x, double y) { return kSlopeX * x + kSlopeY * y; });
    TraversabilityConfig config;
    config.slope.critical_rad = 0.5;
    const TraversabilityLayers layers = rated(map, config);
    const double length = std::sqrt(1.0 + kSlopeX * kSlopeX + kSlopeY * kSlopeY);
    const double angle_rad = std::acos(1.0 / length);
    for (int i = 0; i < 20; ++i) {  // border cells too: a plane stays a plane
        EXPECT_NEAR(layers.normal_x.at(i, 3), -kSlopeX / length, 1e-5) << i;
        EXPECT_NEAR(layers.normal_y.at(i, 3), -kSlopeY / length, 1e-5) << i;
        EXPECT_NEAR(layers.slope.at(i, 3), 1.0 - angle_rad / 0.5, 1e-5) << i;
        EXPECT_NEAR(layers.roughness.at(i, 3), 1.0, 1e-5) << i;
    }
}

TEST(Traversability, SlopeBeyondCriticalIsZero) {
    TraversabilityConfig config;
    config.slope.critical_rad = 0.7;
    const grid::Layer map = map_of(15, 15, [](double x, double) { return x; });  // 45 deg = 0.785
    EXPECT_EQ(rated(map, config).slope.at(7, 7), 0.0F);
}

TEST(Traversability, StepEdgeStopsBothItsSides) {
    // 20 cm up between columns 3 and 4; discs of 5 cells: a step height reaches one cell to each
    // side of the edge, its rating two.
    TraversabilityConfig config;
    config.step = {0.12, 0.025, 0.025, 1};
    const TraversabilityLayers layers = rated(map_cm("0 0 0 0 20 20 20 20\n"
                                                     "0 0 0 0 20 20 20 20\n"
                                                     "0 0 0 0 20 20 20 20\n"
                                                     "0 0 0 0 20 20 20 20"),
                                              config);
    const std::array<float, 8> expected{1, 1, 0, 0, 0, 0, 1, 1};
    for (int ix = 0; ix < 8; ++ix) {
        EXPECT_EQ(layers.step.at(ix, 2), expected[static_cast<std::size_t>(ix)]) << "column " << ix;
    }
}

TEST(Traversability, StepDoesNotDependOnTheHeightOfTheFloor) {
    // A search window that starts at height 0 would find a step of 5 m everywhere here.
    const TraversabilityLayers layers = rated(map_cm("500 500 500\n500 500 500\n500 500 500"));
    EXPECT_EQ(layers.step.at(1, 1), 1.0F);
}

TEST(Traversability, FewCriticalCellsScaleTheStepDown) {
    // One spike of 20 cm: the five cells around it have a critical step height; all of them lie
    // within the second disc of the spike.
    TraversabilityConfig config;
    config.step = {0.12, 0.025, 0.025, 10};
    const grid::Layer map = map_cm("0 0 0 0 0\n0 0 0 0 0\n0 0 20 0 0\n0 0 0 0 0\n0 0 0 0 0");
    // s = min(0.2, 5 / 10 * 0.2) = 0.1 at the spike; one critical cell: s = 0.02 two cells away.
    const TraversabilityLayers layers = rated(map, config);
    EXPECT_NEAR(layers.step.at(2, 2), 1.0 - 0.1 / 0.12, kRounding);
    EXPECT_NEAR(layers.step.at(4, 2), 1.0 - 0.02 / 0.12, kRounding);
    EXPECT_EQ(layers.step.at(4, 4), 1.0F);
    config.step.critical_cells = 5;
    EXPECT_EQ(rated(map, config).step.at(2, 2), 0.0F);
}

TEST(Traversability, StepIsKnownAtHolesWithinReachOnly) {
    TraversabilityConfig config;
    config.step = {0.12, 0.025, 0.025, 1};
    const TraversabilityLayers layers = rated(map_cm("0 0 ? ? ? ?\n0 0 ? ? ? ?"), config);
    EXPECT_EQ(layers.step.at(2, 0), 1.0F);
    EXPECT_TRUE(std::isnan(layers.step.at(3, 0)));
    EXPECT_TRUE(std::isnan(layers.slope.at(2, 0)));
    EXPECT_TRUE(std::isnan(layers.roughness.at(2, 0)));
    EXPECT_TRUE(std::isnan(layers.traversability.at(2, 0)));
}

TEST(Traversability, RoughnessIsTheSampleDeviationFromThePlane) {
    // Chequerboard of +-h: by symmetry the normal is +z at cells whose disc is complete.
    constexpr double kHeight_m = 0.01;
    grid::Layer map(11, 11);
    for (int iy = 0; iy < 11; ++iy) {
        for (int ix = 0; ix < 11; ++ix) {
            map.at(ix, iy) = static_cast<float>((ix + iy) % 2 == 0 ? kHeight_m : -kHeight_m);
        }
    }
    TraversabilityConfig config;
    config.roughness = {0.05, 0.025};
    const TraversabilityLayers layers = rated(map, config);
    // Five cells, one of one sign and four of the other: sum (d - mean)^2 = 5 h^2 - (3 h)^2 / 5.
    const double roughness_m = kHeight_m * std::sqrt((5.0 - 9.0 / 5.0) / 4.0);
    EXPECT_NEAR(layers.roughness.at(5, 5), 1.0 - roughness_m / 0.05, kRounding);
}

TEST(Traversability, DiscOfOneCellMeasuresNothing) {
    TraversabilityConfig config;
    config.normals.radius_m = 0.01;
    config.step.first_radius_m = 0.01;
    ASSERT_TRUE(config.problem(kResolution_m).has_value());
    const TraversabilityLayers layers = rated(grid::Layer(5, 5, 0.0F), config);
    EXPECT_TRUE(std::isnan(layers.normal_x.at(2, 2)));
    EXPECT_TRUE(std::isnan(layers.slope.at(2, 2)));
    EXPECT_TRUE(std::isnan(layers.step.at(2, 2)));
    EXPECT_TRUE(std::isnan(layers.roughness.at(2, 2)));
}

TEST(Traversability, MirroredMapHasMirroredRatings) {
    const grid::Layer map = rough_scene(40, 30, 21);
    grid::Layer mirrored(40, 30);
    for (int iy = 0; iy < 30; ++iy) {
        for (int ix = 0; ix < 40; ++ix) mirrored.at(39 - ix, iy) = map.at(ix, iy);
    }
    const TraversabilityLayers a = rated(map);
    const TraversabilityLayers b = rated(mirrored);
    for (int iy = 0; iy < 30; ++iy) {
        for (int ix = 0; ix < 40; ++ix) {
            const auto close = [&](float left, float right) {
                return (std::isnan(left) && std::isnan(right)) ||
                       std::abs(left - right) <= kRounding;
            };
            ASSERT_TRUE(close(a.normal_x.at(ix, iy), -b.normal_x.at(39 - ix, iy)))
                << ix << ' ' << iy;
            ASSERT_TRUE(close(a.normal_y.at(ix, iy), b.normal_y.at(39 - ix, iy)))
                << ix << ' ' << iy;
            ASSERT_TRUE(close(a.step.at(ix, iy), b.step.at(39 - ix, iy))) << ix << ' ' << iy;
            ASSERT_TRUE(close(a.roughness.at(ix, iy), b.roughness.at(39 - ix, iy)))
                << ix << ' ' << iy;
        }
    }
}

TEST(Traversability, EveryExecutorGivesTheSameBytes) {
    const grid::Layer map = rough_scene(70, 61, 22);
    Serial serial;
    Reverse reverse;
    TraversabilityLayers in_order;
    TraversabilityLayers backwards;
    rate({}, map.view(), kResolution_m, serial, in_order);
    rate({}, map.view(), kResolution_m, reverse, backwards);
    EXPECT_EQ(differing_cells(in_order, backwards), 0);
}

TEST(Traversability, RegionGetsTheValuesOfTheWholeMapAndTouchesNothingElse) {
    Serial serial;
    Traversability rater{TraversabilityConfig{}};
    const grid::Layer before = rough_scene(60, 50, 23);
    const grid::Layer after = rough_scene(60, 50, 24);
    const TraversabilityLayers whole = rated(after);
    for (const CellRect& region : {CellRect{20, 10, 17, 25},
                                   CellRect{-5, -5, 9, 9},
                                   CellRect{55, 45, 100, 100},
                                   CellRect{30, 30, 1, 1}}) {
        TraversabilityLayers layers;
        rater.rate(before.view(), kResolution_m, serial, layers);
        const TraversabilityLayers old = layers;
        rater.rate(after.view(), kResolution_m, region, serial, layers);
        const CellRect inside = region.clipped(60, 50);
        for (int iy = 0; iy < 50; ++iy) {
            for (int ix = 0; ix < 60; ++ix) {
                const bool in = ix >= inside.ix0 && ix < inside.ix0 + inside.nx &&
                                iy >= inside.iy0 && iy < inside.iy0 + inside.ny;
                const TraversabilityLayers& expected = in ? whole : old;
                for (std::size_t i = 0; i < all(layers).size(); ++i) {
                    ASSERT_TRUE(same(all(layers)[i]->at(ix, iy), all(expected)[i]->at(ix, iy)))
                        << "layer " << i << " cell " << ix << ' ' << iy << (in ? " in" : " out");
                }
            }
        }
    }
}

TEST(Traversability, UpdatingTheAffectedCellsEqualsRatingAfresh) {
    Serial serial;
    grid::Layer map = rough_scene(60, 50, 25);
    for (const char* name : kPresetNames) {
        const TraversabilityConfig config = *preset(name);
        Traversability rater(config);
        TraversabilityLayers layers;
        rater.rate(std::as_const(map).view(), kResolution_m, serial, layers);
        const CellRect changed{25, 18, 4, 6};
        for (int iy = changed.iy0; iy < changed.iy0 + changed.ny; ++iy) {
            for (int ix = changed.ix0; ix < changed.ix0 + changed.nx; ++ix) map.at(ix, iy) += 0.5F;
        }
        rater.rate(std::as_const(map).view(),
                   kResolution_m,
                   rater.affected_by(changed, kResolution_m),
                   serial,
                   layers);
        EXPECT_EQ(differing_cells(layers, rated(map, config)), 0) << name;
    }
}

TEST(Traversability, LayersOfAnotherSizeAreRatedWhole) {
    Serial serial;
    Traversability rater{TraversabilityConfig{}};
    const grid::Layer map = rough_scene(30, 20, 26);
    TraversabilityLayers layers;
    layers.resize(7, 7);
    rater.rate(map.view(), kResolution_m, CellRect{3, 3, 2, 2}, serial, layers);
    EXPECT_EQ(differing_cells(layers, rated(map)), 0);
}

}  // namespace
}  // namespace surefoot::traversability
