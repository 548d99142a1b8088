// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/ground.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate::testing {
namespace {

Query attestation(double x_m, double y_m, double radius_m, double center_x_m, double center_y_m) {
    Query query = make_query(kForward, x_m, y_m, 1.0, 0.0);
    query.attested = {true,
                      std::llround(center_x_m * 1e4),
                      std::llround(center_y_m * 1e4),
                      static_cast<std::int32_t>(std::lround(radius_m * 1e4)),
                      -123};
    return query;
}

/// The cell that holds a point.
GroundCell cell_of(const Ground& ground, const grid::MapSnapshot& map, double x_m, double y_m) {
    const auto at = static_cast<std::int64_t>(cell_at(map, x_m, y_m));
    return ground.cell(at % map.nx, at / map.nx);
}

TEST(Ground, an_unknown_cell_is_attested_only_when_it_lies_wholly_in_the_circle) {
    Terrain nothing;
    nothing.height.fill(kNanF);
    const auto map = nothing.snapshot();
    Rng rng(6);
    for (int round = 0; round < 20; ++round) {
        const Query query =
            attestation(0.0, 0.0, rng.uniform(0.2, 0.9), 0.1, rng.uniform(-0.1, 0.1));
        const Ground ground(*map, query, rex().limits);
        for (std::int64_t iy = 0; iy < 240; ++iy) {
            for (std::int64_t ix = 0; ix < 240; ++ix) {
                double farthest = 0.0;  // squared distance of the farthest of four corners, 0.1 mm
                for (const std::int64_t corner : {0, 1, 2, 3}) {
                    const auto x = static_cast<double>(-30000 + 250 * (ix + corner % 2) -
                                                       query.attested.center_x_tenth_mm);
                    const auto y = static_cast<double>(-30000 + 250 * (iy + corner / 2) -
                                                       query.attested.center_y_tenth_mm);
                    farthest = std::max(farthest, x * x + y * y);
                }
                const double radius = query.attested.radius_tenth_mm;
                const GroundCell cell = ground.cell(ix, iy);
                ASSERT_EQ(cell.knowledge == Knowledge::attested, farthest <= radius * radius)
                    << ix << " " << iy;
                if (cell.known()) {
                    ASSERT_EQ(cell.height_tenth_mm, -123);
                }
            }
        }
    }
}

TEST(Ground, nobodys_word_holds_where_lines_of_sight_passed_below_it_by_a_drop) {
    Terrain nothing;
    nothing.height.fill(kNanF);
    const auto map = nothing.snapshot();
    const Query query = attestation(0.0, 0.0, 0.5, 0.0, 0.0);  // the ground is at -123
    const Ground ground(*map, query, rex().limits);
    const Ground nobody(*map, make_query(kForward, 0.0, 0.0, 1.0, 0.0), rex().limits);
    const std::size_t at = cell_at(*map, 0.1, 0.1);
    for (const std::int32_t bound : {-623, -100, 5'000}) {
        map->height_tenth_mm[at] = bound;
        EXPECT_EQ(cell_of(ground, *map, 0.1, 0.1).knowledge, Knowledge::attested) << bound;
        EXPECT_EQ(cell_of(ground, *map, 0.1, 0.1).height_tenth_mm, -123) << bound;
        EXPECT_EQ(cell_of(ground, *map, 0.1, 0.1).drop_evidence, 0) << bound;
        EXPECT_EQ(cell_of(nobody, *map, 0.1, 0.1).knowledge, Knowledge::unknown) << bound;
    }
    map->height_tenth_mm[at] = -624;
    EXPECT_EQ(cell_of(ground, *map, 0.1, 0.1).knowledge, Knowledge::unknown);
    EXPECT_EQ(cell_of(ground, *map, 0.1, 0.1).drop_evidence, 255);
    EXPECT_EQ(cell_of(nobody, *map, 0.1, 0.1).drop_evidence, 0) << "below whom is not known";
}

TEST(Ground, a_word_stands_for_an_unsure_measurement_within_15_mm_of_its_own_height) {
    Terrain unsure;
    unsure.variance.fill(0.008F * 0.008F);
    const auto map = unsure.snapshot();
    const Ground ground(*map, attestation(0.0, 0.0, 0.5, 0.0, 0.0), rex().limits);  // at -123
    const std::size_t at = cell_at(*map, 0.1, 0.1);
    for (const auto& [height, stands] :
         {std::pair{27, true}, {28, false}, {-273, true}, {-274, false}, {-123, true}}) {
        map->height_tenth_mm[at] = height;
        EXPECT_EQ(cell_of(ground, *map, 0.1, 0.1).knowledge,
                  stands ? Knowledge::attested : Knowledge::measured)
            << height;
    }
}

TEST(Ground, the_word_is_void_once_base_link_is_outside_of_the_circle) {
    Terrain floor;
    const auto map = floor.snapshot();
    struct Case {
        double x_m, y_m;
        bool holds;
    };
    const Case cases[] = {{0.5, 0.0, true},
                          {0.5001, 0.0, false},
                          {0.0, 0.5, true},
                          {0.0, -0.5, true},
                          {0.0, -0.5001, false},
                          {0.3, 0.4, true},
                          {0.4, 0.4, false},
                          {90'000.0, 0.0, false}};
    for (const Case& c : cases)
        EXPECT_EQ(
            Ground(*map, attestation(c.x_m, c.y_m, 0.5, 0.0, 0.0), rex().limits).is_attesting(),
            c.holds)
            << c.x_m << " " << c.y_m;
    Query inactive = attestation(0.0, 0.0, 0.5, 0.0, 0.0);
    inactive.attested.active = false;
    EXPECT_FALSE(Ground(*map, inactive, rex().limits).is_attesting() &&
                 Ground(*map, inactive, rex().limits).attested().radius_tenth_mm > 0);
}

TEST(Ground, cells_are_known_by_measurement_only_and_outside_is_not_unknown) {
    Terrain floor;
    const auto map = floor.snapshot();
    const Ground ground(*map, make_query(kForward, 0.0, 0.0, 1.0, 0.0), rex().limits);
    EXPECT_EQ(ground.cell(0, 0).knowledge, Knowledge::measured);
    for (const auto& [ix, iy] : {std::pair{-1, 0}, {0, -1}, {240, 0}, {0, 240}})
        EXPECT_EQ(ground.cell(ix, iy).knowledge, Knowledge::outside) << ix << " " << iy;
    map->source[0] = grid::EvidenceSource::attested;  // a map cannot contain attested cells
    EXPECT_EQ(ground.cell(0, 0).knowledge, Knowledge::unknown);
    map->source[0] = static_cast<grid::EvidenceSource>(9);
    EXPECT_EQ(ground.cell(0, 0).knowledge, Knowledge::unknown);
    map->source[0] = grid::EvidenceSource::measured;
    map->height_tenth_mm[0] = grid::MapSnapshot::kUnknownHeight;
    EXPECT_EQ(ground.cell(0, 0).knowledge, Knowledge::unknown);
}

TEST(ReachableSurfaces, hold_exactly_what_was_added_and_never_the_label_none) {
    ReachableSurfaces surfaces;
    surfaces.add(0);
    surfaces.add(1);
    surfaces.add(64);
    surfaces.add(65535);
    for (std::uint32_t label = 0; label <= 0xffff; ++label)
        EXPECT_EQ(surfaces.contains(static_cast<std::uint16_t>(label)),
                  label == 1 || label == 64 || label == 65535)
            << label;
}

TEST(Ground, a_zone_is_the_sweep_and_the_attested_area_with_a_cell_beside_both) {
    Terrain floor;
    const auto map = floor.snapshot();
    const auto zone_with = [&](const Query& query) {
        const Sweep sweep = sweep_of(rex(), FixedPose{}, rex().movements[kForward]);
        return Ground(*map, query, rex().limits).zone_of(sweep);
    };
    const Query plain = make_query(kForward, 0.0, 0.0, 1.0, 0.0);
    const Extent without = zone_with(plain);
    const Extent sweep = extent_of(sweep_of(rex(), FixedPose{}, rex().movements[kForward]));
    EXPECT_EQ(without.low, (grid::FixedPoint{sweep.low.x - 250, sweep.low.y - 250}));
    EXPECT_EQ(without.high, (grid::FixedPoint{sweep.high.x + 250, sweep.high.y + 250}));
    const Extent with = zone_with(attestation(0.0, 0.0, 1.0, 0.1, -0.2));
    EXPECT_EQ(with.low, (grid::FixedPoint{1000 - 10'250, -2000 - 10'250}));
    EXPECT_EQ(with.high, (grid::FixedPoint{1000 + 10'250, -2000 + 10'250}));
    const Extent void_word = zone_with(attestation(2.0, 0.0, 1.0, 0.0, 0.0));
    EXPECT_EQ(void_word.low, without.low);
    EXPECT_EQ(void_word.high, without.high);
}

TEST(Ground, is_intact_where_nobody_changed_a_row_of_the_zone) {
    Terrain floor;
    const auto map = floor.snapshot();
    const Ground ground(*map, make_query(kForward, 0.0, 0.0, 1.0, 0.0), rex().limits);
    const Extent low{{-20'000, -25'000}, {20'000, -24'000}};
    const Extent high{{-20'000, 24'000}, {20'000, 25'000}};
    EXPECT_TRUE(ground.is_intact(low));
    map->height_tenth_mm[cell_at(*map, 2.5, 2.45)] ^= 1;  // beside the zone, but in its rows
    EXPECT_TRUE(ground.is_intact(low));
    EXPECT_FALSE(ground.is_intact(high));
    EXPECT_FALSE(ground.is_intact({low.low, high.high}));
    EXPECT_FALSE(ground.is_intact({{0, 0}, {0, 24'500}}));
    map->height_tenth_mm[cell_at(*map, 2.5, 2.45)] ^= 1;
    map->height_tenth_mm[cell_at(*map, 2.5, -2.45)] ^= 1;
    EXPECT_TRUE(ground.is_intact(high));
    EXPECT_FALSE(ground.is_intact(low));
}

TEST(Ground, all_around_asks_the_eight_and_not_the_one) {
    Terrain floor;
    const auto map = floor.snapshot();
    const Ground ground(*map, make_query(kForward, 0.0, 0.0, 1.0, 0.0), rex().limits);
    const auto is_level = [](const GroundCell& cell, auto, auto) {
        return cell.height_tenth_mm == 0;
    };
    EXPECT_TRUE(ground.all_around(100, 100, is_level));
    map->height_tenth_mm[100 * 240 + 100] = 1;
    EXPECT_TRUE(ground.all_around(100, 100, is_level));
    map->source[100 * 240 + 100] = grid::EvidenceSource::unknown;
    EXPECT_TRUE(ground.all_around(100, 100, is_level));
    for (const auto& [ix, iy] : {std::pair{99, 99},
                                 {100, 99},
                                 {101, 99},
                                 {99, 100},
                                 {101, 100},
                                 {99, 101},
                                 {100, 101},
                                 {101, 101}}) {
        const auto at = static_cast<std::size_t>(iy * 240 + ix);
        map->height_tenth_mm[at] = 1;
        EXPECT_FALSE(ground.all_around(100, 100, is_level)) << ix << " " << iy;
        map->height_tenth_mm[at] = 0;
        map->source[at] = grid::EvidenceSource::unknown;
        EXPECT_FALSE(ground.all_around(100, 100, is_level)) << ix << " " << iy;
        map->source[at] = grid::EvidenceSource::measured;
    }
    int asked = 0;
    EXPECT_TRUE(ground.all_around(
        100, 100, [&asked](const GroundCell&, auto, auto) { return ++asked > 0; }));
    EXPECT_EQ(asked, 8);
    EXPECT_FALSE(ground.all_around(0, 100, is_level)) << "beyond the map nothing is known";
}

TEST(Ground, a_cell_is_what_the_layers_say_of_it) {
    Terrain floor;
    const auto map = floor.snapshot();
    const std::size_t at = 7 * 240 + 5;
    map->height_tenth_mm[at] = -11;
    map->sigma_tenth_mm[at] = 22;
    map->drift_tenth_mm[at] = 33;
    map->clearance_tenth_mm[at] = 44;
    map->component[at] = 55;
    map->drop_evidence[at] = 66;
    const Ground ground(*map, make_query(kForward, 0.0, 0.0, 1.0, 0.0), rex().limits);
    const GroundCell cell = ground.cell(5, 7);
    EXPECT_EQ(cell.knowledge, Knowledge::measured);
    EXPECT_EQ(cell.height_tenth_mm, -11);
    EXPECT_EQ(cell.sigma_tenth_mm, 22);
    EXPECT_EQ(cell.drift_tenth_mm, 33);
    EXPECT_EQ(cell.clearance_tenth_mm, 44);
    EXPECT_EQ(cell.component, 55);
    EXPECT_EQ(cell.drop_evidence, 66);
    EXPECT_EQ(ground.doubled_center(5, 7, {100, -200}),
              (grid::FixedPoint{2 * (-30'000 - 100) + 11 * 250, 2 * (-30'000 + 200) + 15 * 250}));
    map->source[at] = grid::EvidenceSource::unknown;
    const GroundCell unknown = ground.cell(5, 7);
    EXPECT_EQ(unknown.drop_evidence, 66) << "an edge needs no measurement";
    EXPECT_EQ(unknown.component, grid::MapSnapshot::kNoComponent);
    EXPECT_EQ(unknown.height_tenth_mm, 0);
    EXPECT_EQ(unknown.clearance_tenth_mm, grid::MapSnapshot::kNoCeiling);
}

/// The surfaces beside an attested area, compared with plain distances.
TEST(ReachableSurfaces, beside_an_attested_area_reach_a_cell_and_a_step) {
    Terrain floor;
    const auto map = floor.snapshot();
    for (std::size_t i = 0; i < 240UL * 240UL; ++i)
        map->component[i] = static_cast<std::uint16_t>(i % 60'000 + 1);  // each cell its own
    const Query query = attestation(0.31, -0.42, 0.5, 0.3, -0.4);
    std::size_t lower = cell_at(*map, 0.3, -0.3);
    map->height_tenth_mm.fill(-123);
    map->height_tenth_mm[lower] = -123 - 401;
    map->height_tenth_mm[lower + 1] = -123 - 400;
    map->height_tenth_mm[lower + 2] = -123 + 400;
    map->height_tenth_mm[lower + 3] = -123 + 401;
    map->source[lower + 4] = grid::EvidenceSource::unknown;
    ReachableSurfaces surfaces;
    surfaces.add_beside_attested(Ground(*map, query, rex().limits), 400);
    for (std::size_t i = 0; i < 240UL * 240UL; ++i) {
        const double x = -3.0 + 0.025 * (static_cast<double>(i % 240) + 0.5) - 0.3;
        const double y = -3.0 + 0.025 * (static_cast<double>(i / 240) + 0.5) + 0.4;
        const bool near = x * x + y * y <= 0.525 * 0.525 + 1e-9;
        const bool excluded = i == lower || i == lower + 3 || i == lower + 4;
        ASSERT_EQ(surfaces.contains(map->component[i]), near && !excluded) << i;
    }
    // The centre of a cell lies exactly at the reach, on all four sides.
    const Query centred = attestation(0.3125, -0.4125, 0.5, 0.3125, -0.4125);
    ReachableSurfaces rim;
    rim.add_beside_attested(Ground(*map, centred, rex().limits), 400);
    for (const auto& [x, y] : {std::pair{0.525, 0.0}, {-0.525, 0.0}, {0.0, 0.525}, {0.0, -0.525}})
        EXPECT_TRUE(rim.contains(map->component[cell_at(*map, 0.3125 + x, -0.4125 + y)]))
            << x << " " << y;
    ReachableSurfaces none;
    none.add_beside_attested(Ground(*map, make_query(kForward, 0.3, -0.4, 1.0, 0.0), rex().limits),
                             400);
    EXPECT_FALSE(none.contains(map->component[lower + 1]));
}

TEST(ReachableSurfaces, of_an_attested_area_are_those_that_it_touches_at_its_height) {
    Terrain islands;
    islands.height.fill(kNanF);
    islands.box(0.50, 0.60, -0.05, 0.05, 0.0);  // touches the circle of 0.5 m
    islands.box(0.70, 0.80, -0.05, 0.05, 0.0);  // too far away
    islands.box(-0.3, -0.2, -0.05, 0.05, 0.3);  // inside, but a box of 0.3 m
    islands.box(-0.05, 0.05, 0.2, 0.3, 0.02);   // inside
    const auto map = islands.snapshot();
    Query query = attestation(0.0, 0.0, 0.5, 0.0, 0.0);
    query.attested.height_tenth_mm = 0;
    ReachableSurfaces surfaces;
    surfaces.add_beside_attested(Ground(*map, query, rex().limits), 400);
    const auto contains = [&](double x, double y) {
        return surfaces.contains(map->component[cell_at(*map, x, y)]);
    };
    EXPECT_TRUE(contains(0.55, 0.0));
    EXPECT_FALSE(contains(0.75, 0.0));
    EXPECT_FALSE(contains(-0.25, 0.0));
    EXPECT_TRUE(contains(0.0, 0.25));
}

}  // namespace
}  // namespace surefoot::gate::testing
