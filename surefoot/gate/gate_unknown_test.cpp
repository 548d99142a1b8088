// SPDX-License-Identifier: Apache-2.0
// Unknown ground, and ground beyond the map.
#include <gtest/gtest.h>

#include <cmath>

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

TEST(Gate, any_single_unknown_cell_that_feet_or_body_come_over_inhibits) {
    Terrain floor;
    const auto map = floor.snapshot();
    const Machine machine = rex();
    // From the heels to the drop band ahead of the toes. Between and beside the feet, only ground
    // ahead of the body (0.38 m) and behind its new front (0.78 m) matters.
    for (double x = -0.13; x < 0.73; x += 0.025) {
        for (const double y : {-0.3, -0.18, 0.0, 0.18, 0.3}) {
            const bool way_of_foot = std::abs(std::abs(y) - 0.18) < 0.01;
            if (!way_of_foot && x < 0.41) continue;
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

/// The body passes over unknown ground that it fills now, or that nothing can stand out of.
TEST(Gate, ground_below_the_body_may_be_unknown_where_the_space_is_free) {
    const Machine machine = rex();
    const auto ask_about = [&](double x, double y, std::int32_t bound, std::uint8_t code) {
        Terrain floor;
        const auto map = floor.snapshot();
        for (const double side : {-0.0125, 0.0125}) {
            for (const double along : {-0.0125, 0.0125}) {
                const std::size_t at = cell_at(*map, x + along, y + side);
                map->source[at] = grid::EvidenceSource::unknown;
                map->height_tenth_mm[at] = bound;
            }
        }
        seal(*map);
        return decide(machine, query_at_body(code, *map), *map, kReady, kNowNs);
    };
    constexpr std::int32_t kNothing = grid::MapSnapshot::kUnknownHeight;
    constexpr double kAhead_m = 0.8;  // beyond the drop bands of the feet
    // Behind the heels and between the feet the body stands now.
    expect_ok(ask_about(-0.35, 0.0, kNothing, kForward));
    expect_ok(ask_about(0.1, 0.0, kNothing, kForward));
    // It comes to the ground ahead, and with a step back to the ground behind.
    expect_refused(ask_about(kAhead_m, 0.0, kNothing, kForward), Reason::unknown_cells);
    expect_refused(ask_about(-0.55, 0.0, kNothing, kBackward), Reason::unknown_cells);
    // Its lower edge is 0.144 m over the soles. Lines of sight below it show free space there ...
    expect_ok(ask_about(kAhead_m, 0.0, 1440, kForward));
    expect_refused(ask_about(kAhead_m, 0.0, 1441, kForward), Reason::unknown_cells);
    // ... also below the ground, unless they show a drop near a foot.
    expect_ok(ask_about(kAhead_m, 0.0, -499, kForward));
    expect_refused(ask_about(kAhead_m, 0.0, -500, kForward), Reason::drop_off);
    // A small step to the left brings the body over new ground there, and only there. With its
    // margins it reaches 0.3975 m to each side now.
    const auto half_step = [&](double y) {
        Terrain floor;
        const auto map = floor.snapshot();
        const std::size_t at = cell_at(*map, -0.30, y);
        map->source[at] = grid::EvidenceSource::unknown;
        map->height_tenth_mm[at] = kNothing;
        seal(*map);
        Machine small = machine;
        small.movements[kLeft].left_tenth_mm = 500;
        return decide(small, query_at_body(kLeft, *map), *map, kReady, kNowNs);
    };
    expect_ok(half_step(0.36));
    expect_refused(half_step(0.39), Reason::unknown_cells);
    expect_refused(half_step(0.44), Reason::unknown_cells);
    expect_ok(half_step(0.46));
    expect_ok(half_step(-0.39));
    // Under a foot and in its drop band nothing but known ground counts.
    expect_refused(ask_about(0.5, 0.18, 0, kForward), Reason::unknown_cells);
    expect_refused(ask_about(0.72, 0.18, 0, kForward), Reason::unknown_cells);
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
