// SPDX-License-Identifier: Apache-2.0
// The body on its way down and up.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <set>
#include <utility>

#include "surefoot/core/rng.hpp"
#include "surefoot/gate/tread_support.hpp"
#include "surefoot/gate/tread_testing.hpp"

namespace surefoot::gate::testing {
namespace {

TEST(TreadBounds, a_lowered_body_passes_what_is_just_as_high_as_it_begins) {
    OnTreads on;
    on.map->height_tenth_mm.fill(0);
    Treads treads{Tread{true, -1500, kNone, kNone, 0}, Tread{true, -1400, kNone, kNone, 0}};
    on.machine.body.parts[0] = {{0, 0, 6600, 6450}, 1500, 20'500};
    on.query.stance_height_tenth_mm = 30;
    on.map->height_tenth_mm.fill(30);
    const auto said = [&] {
        Findings findings;
        check_body_lowered(on.scene(), treads, findings);
        return findings.reasons().contains(Reason::body_clearance);
    };
    EXPECT_FALSE(said());  // 1500 over the lower tread
    treads[0].rise_tenth_mm = -1501;
    EXPECT_TRUE(said());
    std::swap(treads[0], treads[1]);  // the lower one counts
    EXPECT_TRUE(said());
    // Level or up: the path of the body was tested before.
    on.map->height_tenth_mm.fill(5000);
    treads = {};
    EXPECT_FALSE(said());
    treads[0].rise_tenth_mm = treads[1].rise_tenth_mm = -1;
    EXPECT_TRUE(said());
}

TEST(TreadBounds, a_lowered_body_asks_the_cells_below_its_parts_with_sway_and_a_cell) {
    Rng rng(95);
    OnTreads on;
    const Treads treads{Tread{true, -1500, kNone, kNone, 0}, Tread{true, -1500, kNone, kNone, 0}};
    on.machine.body.parts[0] = {{701, 2303, 3001, 2803}, 1600, 6100};
    on.machine.body.parts[1] = {{-100, 0, 7200, 401}, 1600, 20'500};
    on.machine.body.count = 2;
    on.machine.body.sway_tenth_mm = 200;
    on.map->height_tenth_mm.fill(0);
    for (int round = 0; round < 10; ++round) {
        on.place_anywhere(rng);
        std::set<std::size_t> wanted;
        for (const BodyPart& part : on.machine.body.all()) {
            // The box, wider by half a tenth of a millimetre where its size is odd.
            std::array<grid::FixedPoint, 4> corners;
            for (std::size_t i = 0; i < 4; ++i) {
                const auto half = [](std::int32_t size) { return size / 2 + size % 2 + 450; };
                const std::int64_t x = half(part.box.length_tenth_mm) * (i % 2 == 0 ? 1 : -1);
                const std::int64_t y = half(part.box.width_tenth_mm) * (i < 2 ? 1 : -1);
                corners[i] = to_odom(on.sweep.target,
                                     part.box.center_x_tenth_mm + x,
                                     part.box.center_y_tenth_mm + y);
            }
            on.each_cell(grid::convex_hull(corners), [&](std::int64_t ix, std::int64_t iy) {
                wanted.insert(on.index(ix, iy));
            });
        }
        const std::int64_t reach = 40;
        const std::int64_t cx = (on.sweep.target.position.x - on.map->origin_x_tenth_mm) / 250;
        const std::int64_t cy = (on.sweep.target.position.y - on.map->origin_y_tenth_mm) / 250;
        for (std::int64_t iy = cy - reach; iy <= cy + reach; ++iy) {
            for (std::int64_t ix = cx - reach; ix <= cx + reach; ++ix) {
                const std::size_t at = on.index(ix, iy);
                on.map->height_tenth_mm[at] = 101;  // one unit above the lower edge of the part
                Findings findings;
                check_body_lowered(on.scene(), treads, findings);
                const Finding* worst = findings.worst(Reason::body_clearance);
                ASSERT_EQ(worst != nullptr, wanted.contains(at)) << round << " " << ix << " " << iy;
                if (worst != nullptr) {
                    ASSERT_EQ(worst->cell_x, ix);
                    ASSERT_EQ(worst->cell_y, iy);
                    ASSERT_EQ(worst->foot, Foot::none);
                    ASSERT_EQ(worst->value_tenth_mm, 1601);
                    ASSERT_EQ(worst->limit_tenth_mm, 1600);
                    ASSERT_FALSE(worst->overhead);
                }
                on.map->height_tenth_mm[at] = 0;
            }
        }
    }
    // Unknown cells report nothing.
    on.map->source.fill(grid::EvidenceSource::unknown);
    on.map->height_tenth_mm.fill(5000);
    Findings findings;
    check_body_lowered(on.scene(), treads, findings);
    EXPECT_TRUE(findings.reasons().empty());
}

TEST(TreadBounds, a_body_is_lifted_by_the_higher_tread_and_never_lowered) {
    const auto lift = [](std::int64_t left, std::int64_t right) {
        Treads treads;
        treads[0].rise_tenth_mm = left;
        treads[1].rise_tenth_mm = right;
        return lift_of(treads);
    };
    EXPECT_EQ(lift(0, 0), 0);
    EXPECT_EQ(lift(1500, 1480), 1500);
    EXPECT_EQ(lift(1, 20), 20);
    EXPECT_EQ(lift(-1500, -1), 0);
    EXPECT_EQ(lift(-1500, 1), 1);
}

}  // namespace
}  // namespace surefoot::gate::testing
