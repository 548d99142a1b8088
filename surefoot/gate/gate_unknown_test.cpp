// SPDX-License-Identifier: Apache-2.0
// Unknown ground, and ground beyond the map.
#include <gtest/gtest.h>

#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/verdict_testing.hpp"

namespace surefoot::gate::testing {
namespace {

TEST(Gate, given_an_empty_map_then_nothing_is_ok) {
    Terrain nothing;
    nothing.height.fill(kNanF);
    for (int code = 1; code < Machine::kMovementCodes; ++code)
        expect_refused(ask(nothing, static_cast<std::uint8_t>(code)), Reason::unknown_cells);
}

TEST(Gate, given_one_unknown_cell_under_the_landing_foot_then_it_is_named) {
    Terrain floor;
    floor.paint(floor.height, 0.45, 0.474, 0.175, 0.199, static_cast<double>(kNanF));
    const Verdict verdict = ask(floor, kForward);
    expect_refused(verdict, Reason::unknown_cells);
    EXPECT_EQ(verdict.evidence.worst_x_tenth_mm, 4625);
    EXPECT_EQ(verdict.evidence.worst_y_tenth_mm, 1875);
    EXPECT_EQ(verdict.evidence.foot, Foot::left);
    EXPECT_LT(verdict.evidence.known_cells, verdict.evidence.cells);
    expect_ok(ask(floor, kBackward));  // backwards this ground is not needed
}

TEST(Gate, any_single_unknown_cell_of_the_swept_area_inhibits) {
    Terrain floor;
    const auto map = floor.snapshot();
    const Machine machine = rex();
    // Everything between the rear of the body at the start and the drop band ahead of the toes.
    for (double x = -0.36; x < 0.73; x += 0.025) {
        for (const double y : {-0.3, -0.18, 0.0, 0.18, 0.3}) {
            const std::size_t at = cell_at(*map, x, y);
            const auto before = map->source[at];
            map->source[at] = grid::EvidenceSource::unknown;
            seal(*map);
            const Verdict verdict =
                decide(machine, query_at_body(kForward, *map), *map, kReady, kNowNs);
            EXPECT_EQ(verdict.primary, Reason::unknown_cells) << x << " " << y << words(verdict);
            map->source[at] = before;
        }
    }
}

TEST(Gate, given_ground_never_seen_ahead_then_a_step_there_is_refused) {
    Terrain floor;
    floor.draw({"????????????",  //
                "????????????",  //
                "????????????",  //
                "............",  //
                "............",  //
                "............",  //
                "............",  //
                "............",  //
                "............",  //
                "............",  //
                "............",  //
                "............"});
    expect_refused(ask(floor, kForward), Reason::unknown_cells);
    expect_ok(ask(floor, kBackward));
    expect_ok(ask(floor, kLeft));
}

TEST(Gate, given_the_edge_of_the_map_ahead_then_outside_map) {
    Terrain floor;
    floor.input.T_odom_body.translation_m.x() = 2.4;
    expect_refused(ask(floor, kForward), Reason::outside_map);
    expect_ok(ask(floor, kBackward));
    floor.input.T_odom_body.translation_m.x() = 50.0;
    const Verdict off_the_map = ask(floor, kBackward);
    expect_refused(off_the_map, Reason::outside_map);
    EXPECT_TRUE(off_the_map.reasons.contains(Reason::unknown_cells)) << "no stance either";
}

}  // namespace
}  // namespace surefoot::gate::testing
