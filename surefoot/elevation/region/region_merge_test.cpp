// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/region/region_merge.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::elevation {
namespace {

using grid::LatticeBox;
using grid::MapRegion;

/// A variance computed in double and rounded to float once, as a share of it.
constexpr double kFloatRounding = 6e-8;

/// Heights around 0 with sigmas of 3 to 20 mm; some cells unknown, some sighting times equal.
MapRegion random_region(const LatticeBox& box, std::uint64_t seed) {
    Rng rng(seed);
    MapRegion r;
    r.box = box;
    r.stamp_ns = 100 + static_cast<std::int64_t>(seed);
    r.config_hash = seed;
    grid::for_each_layer([&](const grid::RegionLayer&, auto member, auto unknown) {
        r.*member = std::decay_t<decltype(r.*member)>(box.nx, box.ny, unknown);
    });
    const auto uniform = [&](double low, double high) {
        return static_cast<float>(rng.uniform(low, high));
    };
    for (std::size_t i = 0; i < r.height_m.size(); ++i) {
        if (rng.below(4) == 0) continue;
        const float sigma_m = uniform(0.003, 0.02);
        r.height_m.data()[i] = uniform(-0.04, 0.04);
        r.height_var_m2.data()[i] = sigma_m * sigma_m;
        r.count.data()[i] = 1 + static_cast<std::uint32_t>(rng.below(9));
        r.seen_ns.data()[i] = static_cast<std::int64_t>(rng.below(4));
        r.horizontal_drift_m.data()[i] = uniform(0.0, 0.05);
        r.lowest_m.data()[i] = uniform(-0.1, 0.0);
        r.highest_m.data()[i] = uniform(0.0, 0.1);
        r.clearance_m.data()[i] = rng.below(2) == 0 ? kNanF : uniform(0.3, 2.0);
        r.confidence.data()[i] = uniform(0.1, 1.0);
        r.density_ratio.data()[i] = rng.below(2) == 0 ? kNanF : uniform(0.0, 4.0);
    }
    return r;
}

using Place = std::pair<std::int64_t, std::int64_t>;
struct Cell {
    double z_m, var_m2, drift_m, highest_m, lowest_m, clearance_m, confidence, density;
    std::uint32_t count;
    std::int64_t seen_ns;
};
std::map<Place, Cell> cells_of(const MapRegion& r) {
    std::map<Place, Cell> cells;
    for (int iy = 0; iy < r.box.ny; ++iy) {
        for (int ix = 0; ix < r.box.nx; ++ix) {
            if (std::isnan(r.height_m.at(ix, iy))) continue;
            cells[{r.box.first_ix + ix, r.box.first_iy + iy}] = {r.height_m.at(ix, iy),
                                                                 r.height_var_m2.at(ix, iy),
                                                                 r.horizontal_drift_m.at(ix, iy),
                                                                 r.highest_m.at(ix, iy),
                                                                 r.lowest_m.at(ix, iy),
                                                                 r.clearance_m.at(ix, iy),
                                                                 r.confidence.at(ix, iy),
                                                                 r.density_ratio.at(ix, iy),
                                                                 r.count.at(ix, iy),
                                                                 r.seen_ns.at(ix, iy)};
        }
    }
    return cells;
}

/// The rule of region_merge.hpp, written again cell by cell.
Cell expected_of(const Cell& a, const Cell& b, double gate_sigma, double floor_m2, bool shared) {
    const bool b_is_later =
        b.seen_ns > a.seen_ns || (b.seen_ns == a.seen_ns &&
                                  (b.var_m2 < a.var_m2 || (b.var_m2 == a.var_m2 && b.z_m > a.z_m)));
    Cell out = b_is_later ? b : a;
    const double apart_m = a.z_m - b.z_m;
    if (std::abs(apart_m) / std::sqrt(a.var_m2 + b.var_m2) > gate_sigma) {
        out.var_m2 += apart_m * apart_m;
        return out;
    }
    if (shared) {
        const Cell& surer = a.var_m2 < b.var_m2 ? a : b.var_m2 < a.var_m2 ? b : out;
        out.z_m = surer.z_m;
        out.var_m2 = surer.var_m2;
        out.count = std::max(a.count, b.count);
    } else {
        // Equation 6.1 as in Lange 2016.
        out.z_m = (b.var_m2 * a.z_m + a.var_m2 * b.z_m) / (a.var_m2 + b.var_m2);
        out.var_m2 = std::max(floor_m2, a.var_m2 * b.var_m2 / (a.var_m2 + b.var_m2));
        out.count = a.count + b.count;
    }
    if (a.seen_ns == b.seen_ns) {
        out.drift_m = std::max(a.drift_m, b.drift_m);
        out.confidence = std::min(a.confidence, b.confidence);
    }
    out.highest_m = std::max(a.highest_m, b.highest_m);
    out.lowest_m = std::min(a.lowest_m, b.lowest_m);
    out.clearance_m = std::fmin(a.clearance_m, b.clearance_m);
    out.density = std::fmax(a.density, b.density);
    return out;
}

void expect_same(const Cell& got, const Cell& want, const Place& place) {
    const auto at = [&] {
        return "cell " + std::to_string(place.first) + ", " + std::to_string(place.second);
    };
    // A height is a weighted mean of floats below 0.04 m, rounded once.
    EXPECT_NEAR(got.z_m, want.z_m, kFloatRounding) << at();
    EXPECT_NEAR(got.var_m2, want.var_m2, kFloatRounding * want.var_m2) << at();
    EXPECT_EQ(got.count, want.count) << at();
    EXPECT_EQ(got.seen_ns, want.seen_ns) << at();
    EXPECT_EQ(got.drift_m, want.drift_m) << at();
    EXPECT_EQ(got.highest_m, want.highest_m) << at();
    EXPECT_EQ(got.lowest_m, want.lowest_m) << at();
    EXPECT_EQ(got.confidence, want.confidence) << at();
    const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
    EXPECT_TRUE(same(got.clearance_m, want.clearance_m)) << at();
    EXPECT_TRUE(same(got.density, want.density)) << at();
}

class MergeRegions : public ::testing::TestWithParam<RegionErrors> {};

TEST_P(MergeRegions, EveryCellIsThatOfTheOracle) {
    const FusionConfig fusion;
    for (std::uint64_t seed = 1; seed < 20; ++seed) {
        Rng rng(seed);
        const auto offset = [&] { return static_cast<std::int64_t>(rng.below(40)) - 20; };
        const MapRegion a = random_region({offset(), offset(), 23, 17}, 2 * seed);
        const MapRegion b = random_region({offset(), offset(), 14, 29}, 2 * seed + 1);
        MapRegion both = a;
        const auto counts = merge(both, b, fusion, GetParam());
        ASSERT_TRUE(counts.ok()) << counts.error().message;
        ASSERT_EQ(both.problem(), std::nullopt);
        EXPECT_EQ(both.box, grid::united(a.box, b.box));
        EXPECT_EQ(both.stamp_ns, b.stamp_ns);
        EXPECT_EQ(both.config_hash, b.config_hash);
        const auto cells_a = cells_of(a);
        const auto cells_b = cells_of(b);
        auto want = cells_a;
        std::int64_t taken = 0;
        for (const auto& [place, cell] : cells_b) {
            const auto ours = cells_a.find(place);
            taken += ours == cells_a.end() ? 1 : 0;
            want[place] = ours == cells_a.end() ? cell
                                                : expected_of(ours->second,
                                                              cell,
                                                              fusion.gate_sigma,
                                                              fusion.min_height_var_m2,
                                                              GetParam() == RegionErrors::shared);
        }
        EXPECT_EQ(counts->taken, taken);
        EXPECT_EQ(counts->taken + counts->agreed + counts->disagreed,
                  static_cast<std::int64_t>(cells_b.size()));
        const auto got = cells_of(both);
        ASSERT_EQ(got.size(), want.size());
        for (const auto& [place, cell] : got) expect_same(cell, want.at(place), place);
        if (::testing::Test::HasFailure()) FAIL() << "seed " << seed;
    }
}

TEST_P(MergeRegions, DoesNotDependOnWhichIsWhich) {
    const MapRegion a = random_region({0, 0, 20, 20}, 1);
    const MapRegion b = random_region({5, -3, 20, 20}, 2);
    MapRegion ab = a;
    MapRegion ba = b;
    ASSERT_TRUE(merge(ab, b, {}, GetParam()).ok());
    ASSERT_TRUE(merge(ba, a, {}, GetParam()).ok());
    EXPECT_EQ(ab.stamp_ns, ba.stamp_ns);
    grid::for_each_layer([&](const grid::RegionLayer& layer, auto member, auto) {
        const auto& x = ab.*member;
        const auto& y = ba.*member;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const bool both_nan = x.data()[i] != x.data()[i] && y.data()[i] != y.data()[i];
            ASSERT_TRUE(both_nan || x.data()[i] == y.data()[i]) << layer.name << " " << i;
        }
    });
}

INSTANTIATE_TEST_SUITE_P(Errors,
                         MergeRegions,
                         ::testing::Values(RegionErrors::shared, RegionErrors::independent));

TEST(MergeSharedRegions, AMapAddedToItselfIsNoSurer) {
    const MapRegion a = random_region({0, 0, 30, 30}, 3);
    MapRegion twice = a;
    const auto counts = merge(twice, a, {});
    ASSERT_TRUE(counts.ok());
    EXPECT_EQ(counts->disagreed, 0);
    EXPECT_EQ(counts->taken, 0);
    for (std::size_t i = 0; i < a.height_m.size(); ++i) {
        if (std::isnan(a.height_m.data()[i])) continue;
        ASSERT_EQ(twice.height_var_m2.data()[i], a.height_var_m2.data()[i]);
        ASSERT_EQ(twice.height_m.data()[i], a.height_m.data()[i]);
        ASSERT_EQ(twice.count.data()[i], a.count.data()[i]);
    }
}

TEST(MergeIndependentRegions, CountsStopAtTheLargestNumber) {
    MapRegion a = random_region({0, 0, 4, 4}, 5);
    for (std::size_t i = 0; i < a.count.size(); ++i)
        if (a.count.data()[i] > 0) a.count.data()[i] = std::numeric_limits<std::uint32_t>::max();
    const MapRegion b = a;
    ASSERT_TRUE(merge(a, b, {}, RegionErrors::independent).ok());
    EXPECT_EQ(a.problem(), std::nullopt);
    for (std::size_t i = 0; i < a.count.size(); ++i)
        EXPECT_EQ(a.count.data()[i], b.count.data()[i]);
}

TEST(MergeRegionsInWords, WhatDoesNotFitIsSaidAndChangesNothing) {
    const MapRegion a = random_region({0, 0, 5, 5}, 1);
    const auto refused = [&](MapRegion b, RegionErrors errors, const char* words) {
        MapRegion into = a;
        const auto result = merge(into, b, {}, errors);
        ASSERT_FALSE(result.ok()) << words;
        EXPECT_NE(result.error().message.find(words), std::string::npos) << result.error().message;
        EXPECT_EQ(into.box, a.box);
        EXPECT_EQ(into.count, a.count);
    };
    MapRegion b = a;
    b.resolution_m = 0.05;
    refused(b, RegionErrors::shared, "cells of 0.025 m and of 0.05 m");
    b = a;
    b.frame = "map";
    refused(b, RegionErrors::independent, "frame odom, the other in frame map");
    b = a;
    b.frame_since_ns = 7;
    refused(b, RegionErrors::shared, "two runs");
    MapRegion into = a;
    EXPECT_TRUE(merge(into, b, {}, RegionErrors::independent).ok());
    b = a;
    b.box.first_ix = 1'000'000'000'000;
    refused(b, RegionErrors::shared, "no map fits around both regions");
    b = a;
    b.count.data()[0] += b.count.data()[0] == 0 ? 1U : 0U;
    b.height_m.data()[0] = kNanF;
    refused(b, RegionErrors::shared, "cell (0, 0)");
}

}  // namespace
}  // namespace surefoot::elevation
