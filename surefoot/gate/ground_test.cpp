// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/ground.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "surefoot/core/rng.hpp"
#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate::testing {
namespace {

Query vouching(double x_m, double y_m, double radius_m, double center_x_m, double center_y_m) {
    Query query = make_query(kForward, x_m, y_m, 1.0, 0.0);
    query.vouched = {true,
                     std::llround(center_x_m * 1e4),
                     std::llround(center_y_m * 1e4),
                     static_cast<std::int32_t>(std::lround(radius_m * 1e4)),
                     -123};
    return query;
}

TEST(Ground, an_unknown_cell_is_vouched_only_when_it_lies_wholly_in_the_circle) {
    Terrain nothing;
    nothing.height.fill(kNaN);
    const auto map = nothing.snapshot();
    Rng rng(6);
    for (int round = 0; round < 20; ++round) {
        const Query query = vouching(0.0, 0.0, rng.uniform(0.2, 0.9), 0.1, rng.uniform(-0.1, 0.1));
        const Ground ground(*map, query);
        for (std::int64_t iy = 0; iy < 240; ++iy) {
            for (std::int64_t ix = 0; ix < 240; ++ix) {
                double farthest = 0.0;  // of the four corners from the centre, squared, 0.1 mm
                for (const std::int64_t corner : {0, 1, 2, 3}) {
                    const auto x = static_cast<double>(-30000 + 250 * (ix + corner % 2) -
                                                       query.vouched.center_x_tenth_mm);
                    const auto y = static_cast<double>(-30000 + 250 * (iy + corner / 2) -
                                                       query.vouched.center_y_tenth_mm);
                    farthest = std::max(farthest, x * x + y * y);
                }
                const double radius = query.vouched.radius_tenth_mm;
                const GroundCell cell = ground.cell(ix, iy);
                ASSERT_EQ(cell.knowledge == Knowledge::vouched, farthest <= radius * radius)
                    << ix << " " << iy;
                if (cell.known()) {
                    ASSERT_EQ(cell.height_tenth_mm, -123);
                }
            }
        }
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
                          {0.0, -0.5001, false},
                          {0.3, 0.4, true},
                          {0.4, 0.4, false},
                          {90'000.0, 0.0, false}};
    for (const Case& c : cases)
        EXPECT_EQ(Ground(*map, vouching(c.x_m, c.y_m, 0.5, 0.0, 0.0)).is_vouching(), c.holds)
            << c.x_m << " " << c.y_m;
    Query inactive = vouching(0.0, 0.0, 0.5, 0.0, 0.0);
    inactive.vouched.active = false;
    EXPECT_FALSE(Ground(*map, inactive).is_vouching() &&
                 Ground(*map, inactive).vouched().radius_tenth_mm > 0);
}

TEST(Ground, cells_are_known_by_measurement_only_and_outside_is_not_unknown) {
    Terrain floor;
    const auto map = floor.snapshot();
    const Ground ground(*map, make_query(kForward, 0.0, 0.0, 1.0, 0.0));
    EXPECT_EQ(ground.cell(0, 0).knowledge, Knowledge::measured);
    for (const auto& [ix, iy] : {std::pair{-1, 0}, {0, -1}, {240, 0}, {0, 240}})
        EXPECT_EQ(ground.cell(ix, iy).knowledge, Knowledge::outside) << ix << " " << iy;
    map->source[0] = grid::EvidenceSource::vouched;  // nobody vouches inside a map
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

TEST(ReachableSurfaces, of_a_vouched_area_are_those_that_it_touches_at_its_height) {
    Terrain islands;
    islands.height.fill(kNaN);
    islands.box(0.50, 0.60, -0.05, 0.05, 0.0);  // touches the circle of 0.5 m
    islands.box(0.70, 0.80, -0.05, 0.05, 0.0);  // too far away
    islands.box(-0.3, -0.2, -0.05, 0.05, 0.3);  // inside, but a box of 0.3 m
    islands.box(-0.05, 0.05, 0.2, 0.3, 0.02);   // inside
    const auto map = islands.snapshot();
    Query query = vouching(0.0, 0.0, 0.5, 0.0, 0.0);
    query.vouched.height_tenth_mm = 0;
    ReachableSurfaces surfaces;
    surfaces.add_beside_vouched(Ground(*map, query), 400);
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
