// SPDX-License-Identifier: Apache-2.0
// Counts every allocation of this test program. It proves that after the first call, rating a map,
// finding its footholds and querying a footprint allocate nothing.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>

#include "surefoot/core/allocations_testing.hpp"
#include "surefoot/traversability/foothold.hpp"
#include "surefoot/traversability/footprint.hpp"
#include "surefoot/traversability/rating_confidence.hpp"
#include "surefoot/traversability/reachability.hpp"
#include "surefoot/traversability/traversability.hpp"

namespace surefoot::traversability {
namespace {

using heap::allocations;

TEST(TraversabilityAllocation, NoneAfterTheFirstMap) {
    const grid::Layer map(120, 100, 0.25F);
    Serial serial;
    Traversability rater{TraversabilityConfig{}};
    TraversabilityLayers layers;
    rater.rate(map.view(), 0.025, serial, layers);
    const std::int64_t before = allocations;
    rater.rate(map.view(), 0.025, serial, layers);
    rater.rate(map.view(), 0.025, CellRect{10, 10, 30, 30}, serial, layers);
    EXPECT_EQ(allocations - before, 0);
    EXPECT_GT(before, 0) << "the counter works";
}

TEST(TraversabilityAllocation, NoneInReachabilityAfterTheFirstMap) {
    const grid::Layer map(120, 100, 0.25F);
    grid::Layer rough = map;
    for (std::size_t i = 0; i < rough.size(); ++i)
        rough.data()[i] = 0.001F * static_cast<float>(i * 7919 % 101);
    const grid::GridGeometry geometry{0.025, 120, 100, {-1.5, -1.25}};
    Reachability reachability({});
    grid::Layer out;
    const std::int64_t before_first = allocations;
    reachability.reach(geometry, map.view(), {0.0, 0.0}, out);
    const std::int64_t before = allocations;
    EXPECT_GT(before, before_first) << "the counter works";
    reachability.reach(geometry, rough.view(), {0.0, 0.0}, out);
    reachability.reach(geometry, rough.view(), {9.0, 9.0}, out);
    EXPECT_EQ(allocations - before, 0);
}

TEST(TraversabilityAllocation, NoneInConfidenceAfterTheFirstMap) {
    const grid::Layer map(120, 100, 0.25F);
    const grid::Layer var_m2(120, 100, 1e-5F);
    Serial serial;
    Traversability rater{TraversabilityConfig{}};
    TraversabilityLayers layers;
    rater.rate(map.view(), 0.025, serial, layers);
    RatingConfidence confidence(rater.config(), 0.025);
    ConfidenceLayers out;
    const RatingConfidence::Input input{
        map.view(), var_m2.view(), rater.rated_step_heights(), layers};
    const std::int64_t before_first = allocations;
    confidence.compute(input, out);
    const std::int64_t before = allocations;
    EXPECT_GT(before, before_first) << "the counter works";
    confidence.compute(input, out);
    EXPECT_EQ(allocations - before, 0);
}

TEST(TraversabilityAllocation, NoneInFootholdsAfterTheFirstMap) {
    const grid::Layer map(120, 100, 0.25F);
    const grid::Layer var_m2(120, 100, 1e-6F);
    grid::Layer rough = map;
    for (std::size_t i = 0; i < rough.size(); ++i)
        rough.data()[i] = 0.001F * static_cast<float>(i * 7919 % 101);
    const FootholdGround flat{map.view(), var_m2.view(), {}, {}, {}, 0.025};
    const FootholdGround uneven{rough.view(), var_m2.view(), map.view(), map.view(), {}, 0.025};
    FootholdFinder finder{FootholdConfig{}};
    Image<Foothold> out;
    const std::int64_t before_first = allocations;
    finder.find(flat, serial(), out);
    const std::int64_t before = allocations;
    EXPECT_GT(before, before_first) << "the counter works";
    EXPECT_EQ(out.at(60, 50), Foothold::safe);
    finder.find(uneven, serial(), out);
    EXPECT_NE(out.at(60, 50), Foothold::safe) << "the patches were looked at one by one";
    finder.find(flat, serial(), out);
    EXPECT_EQ(allocations - before, 0);
}

TEST(TraversabilityAllocation, NoneInFootprintQueriesAfterTheFirstPath) {
    const grid::Layer map(120, 100, 0.25F);
    const FootprintLayers layers{{0.025, 120, 100, {-1.5, -1.25}}, map.view(), map.view()};
    const auto foot =
        Footprint::polygon(std::array<Eigen::Vector2d, 3>{{{-0.2, -0.1}, {0.2, -0.1}, {0.0, 0.2}}});
    const auto disc = Footprint::circle(0.3);
    ASSERT_TRUE(foot.ok() && disc.ok());
    const std::array<FootprintPose, 3> way{{{-0.5, 0.0, 0.0}, {0.5, 0.0, 0.5}, {0.5, 0.0, 3.0}}};
    PathScratch scratch;
    const std::int64_t before_first = allocations;
    const std::int64_t cells = query_path(*foot, way, layers, scratch).cells;
    const std::int64_t before = allocations;
    EXPECT_GT(before, before_first) << "the counter works";
    EXPECT_EQ(query_path(*foot, way, layers, scratch).cells, cells);
    EXPECT_GT(query(*foot, way[0], layers).cells, 0);
    EXPECT_GT(query(*disc, way[2], layers).cells, 0);
    EXPECT_EQ(allocations - before, 0);
}

}  // namespace
}  // namespace surefoot::traversability
