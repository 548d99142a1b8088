// SPDX-License-Identifier: Apache-2.0
// The fast way against the plain one, and against itself on every instruction set.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/traversability/traversability.hpp"

namespace surefoot::traversability {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Normals agree to 1e-9 rad; rounding to float may then fall to the other side: one digit, 6e-8.
constexpr double kNormalTolerance = 1e-7;
/// 3e-7 rad of the arc cosine plus four roundings of 6e-8, over a critical slope of 0.5 rad or
/// more. A normal on the other side of a rounding turns a slope near 0 by 3.5e-4 rad; that does not
/// happen in these maps.
constexpr double kSlopeTolerance = 1.2e-6;
constexpr double kStepTolerance = 3e-7;       // five roundings of 6e-8
constexpr double kRoughnessTolerance = 3e-7;  // five roundings of 6e-8

struct Case {
    std::string name;
    grid::Layer map;
    double resolution_m;
    TraversabilityConfig config;
};

/// A slope with a step, noise and holes, at the height `base_m`.
grid::Layer noisy(int nx, int ny, double hole_share, double noise_m, double base_m, Rng& rng) {
    grid::Layer map(nx, ny);
    const double slope = rng.uniform(-2.0, 2.0);
    const double step_m = rng.uniform(-0.3, 0.3);
    const int edge = static_cast<int>(rng.below(static_cast<std::uint64_t>(nx)));
    for (int iy = 0; iy < ny; ++iy) {
        for (int ix = 0; ix < nx; ++ix) {
            const double z_m = base_m + 0.025 * slope * iy + (ix > edge ? step_m : 0.0);
            map.at(ix, iy) = rng.uniform() < hole_share
                                 ? kNanF
                                 : static_cast<float>(z_m + noise_m * rng.normal());
        }
    }
    return map;
}

/// Noise that also contains invalid heights.
grid::Layer spoilt(int nx, int ny, Rng& rng) {
    grid::Layer map = noisy(nx, ny, 0.3, 0.003, 0.0, rng);
    const float bad[] = {kNanF, kInfinity, -kInfinity, 1e30F, -1e30F, 3e38F, -3e38F, 1e-40F};
    for (std::size_t i = 0; i < map.size(); ++i) {
        if (rng.uniform() < 0.2) map.data()[i] = bad[rng.below(std::size(bad))];
    }
    return map;
}

std::vector<Case> sound_cases() {
    constexpr std::uint64_t kSeed = 51;
    Rng rng(kSeed);
    std::vector<Case> cases;
    for (const char* name : kPresetNames) {
        for (const double hole_share : {0.0, 0.05, 0.6, 0.95}) {
            for (const int nx : {1, 15, 33, 70}) {
                cases.push_back({std::string(name) + " holes " + std::to_string(hole_share) +
                                     " columns " + std::to_string(nx),
                                 noisy(nx, 45, hole_share, 0.004, 3.0, rng),
                                 0.025,
                                 *preset(name)});
            }
        }
        cases.push_back({std::string(name) + " 1 cm",
                         noisy(50, 43, 0.05, 0.002, 0.0, rng),
                         0.01,
                         *preset(name)});
        cases.push_back({std::string(name) + " 1000 m up",
                         noisy(40, 43, 0.05, 0.02, 1000.0, rng),
                         0.025,
                         *preset(name)});
    }
    TraversabilityConfig wide;
    wide.normals.radius_m = 0.5;  // 20 cells
    wide.roughness.radius_m = 0.6;
    wide.step.second_radius_m = 0.3;
    cases.push_back({"wide discs", noisy(37, 50, 0.1, 0.004, 0.0, rng), 0.025, wide});
    cases.push_back({"wider than the map", noisy(9, 7, 0.1, 0.004, 0.0, rng), 0.025, wide});
    TraversabilityConfig lone;
    lone.roughness.radius_m = 0.01;
    lone.step.second_radius_m = 0.01;
    cases.push_back({"single cells", noisy(20, 20, 0.1, 0.004, 0.0, rng), 0.025, lone});
    return cases;
}

std::vector<Case> spoilt_cases() {
    constexpr std::uint64_t kSeed = 52;
    Rng rng(kSeed);
    std::vector<Case> cases;
    for (const char* name : kPresetNames) {
        cases.push_back({std::string(name) + " spoilt", spoilt(45, 45, rng), 0.025, *preset(name)});
    }
    TraversabilityConfig tiny;
    tiny.normals.radius_m = tiny.step.first_radius_m = 0.001;
    TraversabilityConfig huge;
    huge.normals.radius_m = huge.roughness.radius_m = 5.0;
    huge.step.first_radius_m = huge.step.second_radius_m = 5.0;
    for (const float height_m : {kNanF, kInfinity, 1e30F, 0.0F}) {
        const std::string at = " at " + std::to_string(height_m);
        cases.push_back({"1x1" + at, grid::Layer(1, 1, height_m), 0.025, {}});
        cases.push_back({"1x1 huge discs" + at, grid::Layer(1, 1, height_m), 0.025, huge});
        cases.push_back({"flat" + at, grid::Layer(9, 70, height_m), 0.025, {}});
        cases.push_back({"tiny discs" + at, grid::Layer(5, 4, height_m), 0.025, tiny});
        cases.push_back({"huge discs" + at, grid::Layer(5, 4, height_m), 0.025, huge});
    }
    return cases;
}

TraversabilityLayers rated(const Case& c, Way way) {
    Serial serial;
    Traversability rater(c.config, way);
    TraversabilityLayers layers;
    rater.rate(std::as_const(c.map).view(), c.resolution_m, serial, layers);
    return layers;
}

struct Named {
    const char* name;
    const grid::Layer& layer;
    double tolerance;
};
std::vector<Named> all(const TraversabilityLayers& layers) {
    return {{"normal_x", layers.normal_x, kNormalTolerance},
            {"normal_y", layers.normal_y, kNormalTolerance},
            {"normal_z", layers.normal_z, kNormalTolerance},
            {"slope", layers.slope, kSlopeTolerance},
            {"step", layers.step, kStepTolerance},
            {"roughness", layers.roughness, kRoughnessTolerance},
            {"traversability", layers.traversability, kSlopeTolerance}};
}

/// Expects the same unknown cells, the same zeros, and close values everywhere.
void expect_close(const TraversabilityLayers& ours, const TraversabilityLayers& truth) {
    for (std::size_t k = 0; k < all(truth).size(); ++k) {
        const grid::Layer& a = all(ours)[k].layer;
        const grid::Layer& b = all(truth)[k].layer;
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t i = 0; i < b.size(); ++i) {
            const float ours_i = a.data()[i];
            const float truth_i = b.data()[i];
            const auto where = [&] {
                return std::string(all(truth)[k].name) + " cell " +
                       std::to_string(i % static_cast<std::size_t>(b.width())) + ' ' +
                       std::to_string(i / static_cast<std::size_t>(b.width()));
            };
            ASSERT_EQ(std::isnan(ours_i), std::isnan(truth_i)) << where();
            if (std::isnan(truth_i)) continue;
            ASSERT_NEAR(ours_i, truth_i, all(truth)[k].tolerance) << where();
            if (k > 2) {
                ASSERT_EQ(ours_i == 0.0F, truth_i == 0.0F) << where();
            }
        }
    }
}

/// Expects equal bytes: NaN equals NaN, and 0 differs from -0.
void expect_same_bytes(const TraversabilityLayers& ours, const TraversabilityLayers& truth) {
    for (std::size_t k = 0; k < all(truth).size(); ++k) {
        const grid::Layer& a = all(ours)[k].layer;
        const grid::Layer& b = all(truth)[k].layer;
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t i = 0; i < b.size(); ++i) {
            const bool both_unknown = std::isnan(a.data()[i]) && std::isnan(b.data()[i]);
            ASSERT_TRUE(both_unknown || std::bit_cast<std::uint32_t>(a.data()[i]) ==
                                            std::bit_cast<std::uint32_t>(b.data()[i]))
                << all(truth)[k].name << " element " << i;
        }
    }
}

TEST(TraversabilityFast, AgreesWithThePlainWay) {
    for (const Case& c : sound_cases()) {
        SCOPED_TRACE("seed 51 " + c.name);
        expect_close(rated(c, Way::fast), rated(c, Way::plain));
        if (HasFatalFailure()) return;
    }
}

TEST(TraversabilityFast, AgreesWithThePlainWayOnSpoiltMaps) {
    for (const Case& c : spoilt_cases()) {
        SCOPED_TRACE("seed 52 " + c.name);
        expect_close(rated(c, Way::fast), rated(c, Way::plain));
        if (HasFatalFailure()) return;
    }
}

TEST(TraversabilityFast, SameBytesOnEveryProcessor) {
    for (const auto& cases : {sound_cases(), spoilt_cases()}) {
        for (const Case& c : cases) {
            SCOPED_TRACE(c.name);
            const TraversabilityLayers expected = rated(c, Way::fast);
            for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
                SCOPED_TRACE(hwy::TargetName(target));
                hwy::SetSupportedTargetsForTest(target);
                expect_same_bytes(rated(c, Way::fast), expected);
                hwy::SetSupportedTargetsForTest(0);
                if (HasFatalFailure()) return;
            }
        }
    }
}

/// Single precision must place a step on the same side of the limit, which is a double.
TEST(TraversabilityFast, StepsBesideTheCriticalOneAreCountedAlike) {
    for (const double critical_m : {0.05, 0.1, 0.12, 0.125, 0.3}) {
        TraversabilityConfig config;
        config.step = {critical_m, 0.03, 0.03, 3};
        const auto nearest = static_cast<float>(critical_m);
        for (const float step_m :
             {std::nextafter(nearest, 0.0F), nearest, std::nextafter(nearest, kInfinity)}) {
            Case c{"step", grid::Layer(9, 9, 0.0F), 0.025, config};
            c.map.at(4, 4) = step_m;
            SCOPED_TRACE(std::to_string(critical_m));
            expect_close(rated(c, Way::fast), rated(c, Way::plain));
            if (HasFatalFailure()) return;
        }
    }
}

/// There are so many cells that a difference of 1e-12 in an axis would change some rounding.
TEST(TraversabilityFast, RoughGroundHasTheSameBytesOnEveryProcessor) {
    constexpr std::uint64_t kSeed = 54;
    Rng rng(kSeed);
    const Case c{"rough", noisy(400, 400, 0.1, 0.03, 1.0, rng), 0.025, *preset("rex_zed")};
    const TraversabilityLayers expected = rated(c, Way::fast);
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        SCOPED_TRACE(hwy::TargetName(target));
        hwy::SetSupportedTargetsForTest(target);
        expect_same_bytes(rated(c, Way::fast), expected);
        hwy::SetSupportedTargetsForTest(0);
        if (HasFatalFailure()) return;
    }
}

/// Changes rectangles of a map repeatedly, and rates only the cells that can change.
TEST(TraversabilityFast, UpdatingChangedCellsGivesTheBytesOfAFullRating) {
    constexpr std::uint64_t kSeed = 53;
    Rng rng(kSeed);
    Serial serial;
    for (const char* name : kPresetNames) {
        Case c{name, noisy(101, 90, 0.1, 0.004, 2.0, rng), 0.025, *preset(name)};
        Traversability rater(c.config);
        TraversabilityLayers layers;
        rater.rate(std::as_const(c.map).view(), c.resolution_m, serial, layers);
        for (int round = 0; round < 25; ++round) {
            SCOPED_TRACE(std::string(name) + " seed 53 round " + std::to_string(round));
            const CellRect changed = CellRect{static_cast<int>(rng.below(110)) - 8,
                                              static_cast<int>(rng.below(100)) - 8,
                                              1 + static_cast<int>(rng.below(60)),
                                              1 + static_cast<int>(rng.below(60))}
                                         .clipped(c.map.width(), c.map.height());
            for (int iy = changed.iy0; iy < changed.iy0 + changed.ny; ++iy) {
                for (int ix = changed.ix0; ix < changed.ix0 + changed.nx; ++ix) {
                    c.map.at(ix, iy) =
                        rng.uniform() < 0.1 ? kNanF : static_cast<float>(2.0 + 0.05 * rng.normal());
                }
            }
            rater.rate(std::as_const(c.map).view(),
                       c.resolution_m,
                       rater.affected_by(changed, c.resolution_m),
                       serial,
                       layers);
            expect_same_bytes(layers, rated(c, Way::fast));
            if (HasFatalFailure()) return;
        }
    }
}

/// Heights far from 0 would cancel in n zz - z z if the squares were summed in one number.
TEST(TraversabilityFast, FlatGroundIsExactlyOneFarFromZero) {
    for (const float height_m : {1.1F, -123.456F, 4321.123F}) {
        for (const char* name : kPresetNames) {
            const TraversabilityLayers layers =
                rated({name, grid::Layer(40, 21, height_m), 0.025, *preset(name)}, Way::fast);
            for (std::size_t i = 0; i < layers.roughness.size(); ++i) {
                ASSERT_EQ(layers.roughness.data()[i], 1.0F) << name << " at " << height_m;
                ASSERT_EQ(layers.slope.data()[i], 1.0F) << name << " at " << height_m;
            }
        }
    }
}

/// Ratings of planes tilted about y, whose normals are known.
TEST(TraversabilityFast, SlopesAreThoseOfTheLibraryArcCosine) {
    TraversabilityConfig config;
    config.slope.critical_rad = 1.5;
    for (int degree = 0; degree <= 80; ++degree) {
        const double tangent = std::tan(degree * 3.14159265358979 / 180.0);
        grid::Layer map(20, 20);
        for (int iy = 0; iy < 20; ++iy)
            for (int ix = 0; ix < 20; ++ix) map.at(ix, iy) = static_cast<float>(tangent * ix);
        const TraversabilityLayers layers =
            rated({"plane", map, 1.0, config.widened_to(1.0)}, Way::fast);
        const double slope_rad = std::acos(static_cast<double>(layers.normal_z.at(10, 10)));
        constexpr double kArcTolerance_rad = 1e-6;  // plus two roundings of the rating
        EXPECT_NEAR(
            layers.slope.at(10, 10), 1.0 - slope_rad / 1.5, kArcTolerance_rad / 1.5 + 1.2e-7)
            << degree << " deg";
    }
}

}  // namespace
}  // namespace surefoot::traversability
