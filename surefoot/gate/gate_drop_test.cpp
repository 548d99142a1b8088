// SPDX-License-Identifier: Apache-2.0
// Drops under the feet and beyond the toes.
#include <gtest/gtest.h>

#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/verdict_testing.hpp"

namespace surefoot::gate::testing {
namespace {

TEST(Gate, given_half_a_foot_over_a_platform_edge_then_drop_off) {
    for (const bool below_is_seen : {true, false}) {
        Terrain platform;
        platform.box(0.46, 3.0, -3.0, 3.0, below_is_seen ? -0.5 : static_cast<double>(kNanF));
        const Verdict verdict = ask(platform, kForward);
        expect_refused(verdict, below_is_seen ? Reason::drop_off : Reason::unknown_cells);
        expect_ok(ask(platform, kBackward));
    }
}

TEST(Gate, given_a_drop_in_the_band_beyond_the_toes_then_drop_off) {
    Terrain platform;
    platform.box(0.70, 3.0, -3.0, 3.0, -0.3);  // 0.06 m beyond the toes at 0.64 m
    expect_refused(ask(platform, kForward), Reason::drop_off);
    Terrain farther;
    farther.box(0.87, 3.0, -3.0, 3.0, -0.3);
    expect_ok(ask(farther, kForward));
}

/// The map can show ground beyond the edge of a drop, so a drop just beyond the band counts too.
TEST(Gate, given_a_drop_just_beyond_the_band_then_it_must_be_shallow_or_surely_none) {
    const auto ask_with = [](double height_m, double sigma_m) {
        Terrain floor;
        floor.box(0.775, 0.825, 0.10, 0.25, height_m);
        floor.paint(floor.variance, 0.775, 0.825, 0.10, 0.25, sigma_m * sigma_m);
        return ask(floor, kForward);
    };
    expect_ok(ask_with(-0.049, 0.004));
    expect_refused(ask_with(-0.051, 0.004), Reason::drop_off);
    // A kerb of 75 mm must be out of the question.
    expect_ok(ask_with(-0.025, 0.0146));
    expect_refused(ask_with(-0.025, 0.0148), Reason::not_resolvable);
    // Unknown ground counts only if lines of sight show that it is low.
    for (const auto& [bound, allowed] : {std::pair{-499, true}, {-500, false}}) {
        Terrain floor;
        const auto map = floor.snapshot();
        const std::size_t at = cell_at(*map, 0.8, -0.18);
        map->source[at] = grid::EvidenceSource::unknown;
        map->height_tenth_mm[at] = bound;
        seal(*map);
        const Verdict verdict = decide(rex(), query_at_body(kForward, *map), *map, kReady, kNowNs);
        if (allowed)
            expect_ok(verdict);
        else
            expect_refused(verdict, Reason::drop_off);
    }
}

TEST(Gate, given_only_the_far_side_of_a_drop_was_seen_then_its_edge_is_a_drop) {
    Terrain platform;
    platform.box(0.70, 1.0, -3.0, 3.0, static_cast<double>(kNanF));  // in the shadow of the edge
    platform.box(1.0, 3.0, -3.0, 3.0, -0.3);
    const Verdict verdict = ask(platform, kForward);
    expect_refused(verdict, Reason::drop_off);
    EXPECT_EQ(verdict.evidence.value_tenth_mm, 0) << "the edge shows no depth";
    EXPECT_TRUE(verdict.reasons.contains(Reason::unknown_cells));
}

TEST(Gate, given_a_hole_under_one_foot_then_drop_off) {
    Terrain floor;
    floor.box(0.4, 0.5, -0.2, -0.1, -0.3);
    const Verdict verdict = ask(floor, kForward);
    expect_refused(verdict, Reason::drop_off);
    EXPECT_EQ(verdict.evidence.foot, Foot::right);
    EXPECT_EQ(verdict.evidence.value_tenth_mm, 3000);
}

TEST(Gate, given_a_table_beside_the_way_then_its_edge_is_no_drop) {
    Terrain room;  // the table's rim carries drop evidence; the floor is where we stand
    room.box(-1.0, 2.0, 0.40, 1.0, 0.7);
    expect_ok(ask(room, kForward));
}

TEST(Gate, given_something_under_the_present_feet_then_it_counts_too) {
    Terrain floor;
    floor.box(0.0, 0.05, 0.15, 0.2, 0.3);
    EXPECT_TRUE(ask(floor, kForward).reasons.contains(Reason::corridor_blocked));
    Terrain hole;
    hole.box(0.0, 0.05, 0.15, 0.2, -0.3);
    EXPECT_TRUE(ask(hole, kForward).reasons.contains(Reason::drop_off));
}

}  // namespace
}  // namespace surefoot::gate::testing
