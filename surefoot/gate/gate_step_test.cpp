// SPDX-License-Identifier: Apache-2.0
// How high and how low a foot may land, and on which surface.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/verdict_testing.hpp"

namespace surefoot::gate::testing {
namespace {

TEST(Gate, given_the_top_of_a_table_then_it_is_flat_but_not_reachable) {
    Terrain top;
    top.box(0.26, 3.0, -3.0, 3.0, 0.7);
    const Verdict verdict = ask(top, kForward);
    expect_refused(verdict, Reason::step_too_high);
    EXPECT_EQ(verdict.evidence.height_delta_tenth_mm, 7000);
    EXPECT_TRUE(verdict.reasons.contains(Reason::disconnected)) << words(verdict);
    EXPECT_TRUE(verdict.reasons.contains(Reason::corridor_blocked));
}

TEST(Gate, kerbs_up_and_down_are_refused_and_small_steps_are_not) {
    struct Case {
        double height_m;
        Decision decision;
        Reason primary;
    };
    const Case cases[] = {{0.015, Decision::ok, Reason::none},
                          {0.025, Decision::not_traversable, Reason::step_too_high},
                          {0.075, Decision::not_traversable, Reason::step_too_high},
                          {-0.015, Decision::ok, Reason::none},
                          {-0.025, Decision::not_traversable, Reason::step_too_low},
                          {-0.075, Decision::not_traversable, Reason::drop_off}};
    for (const Case& c : cases) {
        Terrain street;
        street.box(0.26, 3.0, -3.0, 3.0, c.height_m);
        const Verdict verdict = ask(street, kForward);
        EXPECT_EQ(verdict.decision, c.decision) << c.height_m << " " << words(verdict);
        EXPECT_EQ(verdict.primary, c.primary) << c.height_m << " " << words(verdict);
    }
}

TEST(Gate, a_toe_on_the_beginning_of_a_ramp_is_a_step_though_the_middle_of_the_foot_is_none) {
    // The landing feet reach from 0.274 to 0.640 m; 1:8 from x on lifts the toes by 14 or 26 mm.
    for (const auto& [begin_m, allowed] : {std::pair{0.53, true}, std::pair{0.43, false}}) {
        for (const double sign : {1.0, -1.0}) {
            Terrain ramp;
            for (int v = 0; v < 240; ++v) {
                for (int u = 0; u < 240; ++u) {
                    const double x_m = ramp.geometry.center_m({u, v}).x();
                    const double on_m = std::clamp(x_m - begin_m, 0.0, 0.70 - begin_m);
                    ramp.height.at(u, v) = static_cast<float>(sign * on_m / 8.0);
                }
            }
            const Verdict verdict = ask(ramp, kForward);
            if (allowed) {
                expect_ok(verdict);
                continue;
            }
            expect_refused(verdict, sign > 0.0 ? Reason::step_too_high : Reason::step_too_low);
            EXPECT_EQ(verdict.evidence.limit_tenth_mm, 200);
            EXPECT_NEAR(static_cast<double>(verdict.evidence.value_tenth_mm), 260.0, 16.0);
            EXPECT_NEAR(static_cast<double>(verdict.evidence.worst_x_tenth_mm), 6375.0, 1.0);
            EXPECT_NE(verdict.evidence.foot, Foot::none);
        }
    }
}

TEST(Gate, one_cell_alone_above_or_below_the_step_is_no_step_but_two_are) {
    for (const double sign : {1.0, -1.0}) {
        const Reason step = sign > 0.0 ? Reason::step_too_high : Reason::step_too_low;
        Terrain pebble;
        pebble.box(0.40, 0.425, 0.15, 0.175, sign * 0.030);
        expect_ok(ask(pebble, kForward));
        for (const auto& [x0, y0] : {std::pair{0.425, 0.15}, {0.425, 0.175}, {0.375, 0.175}}) {
            Terrain two = pebble;
            two.box(x0, x0 + 0.025, y0, y0 + 0.025, sign * 0.030);
            EXPECT_TRUE(ask(two, kForward).reasons.contains(step)) << x0 << " " << y0;
        }
        Terrain unseen = pebble;
        unseen.box(0.425, 0.45, 0.15, 0.175, kNanF);
        expect_refused(ask(unseen, kForward), Reason::unknown_cells);
    }
    // On rows of pegs the whole foot would stand: one peg under a foot is a pebble, two are not.
    Terrain pegs;
    pegs.box(0.40, 0.425, 0.15, 0.175, 0.036);
    expect_ok(ask(pegs, kForward));
    pegs.box(0.50, 0.525, 0.15, 0.175, 0.036);
    EXPECT_TRUE(ask(pegs, kForward).reasons.contains(Reason::step_too_high));
    Terrain one_each;
    one_each.box(0.40, 0.425, 0.15, 0.175, 0.036).box(0.40, 0.425, -0.175, -0.15, 0.036);
    expect_ok(ask(one_each, kForward));
    Terrain post;
    post.box(0.40, 0.425, 0.15, 0.175, 0.041);
    EXPECT_TRUE(ask(post, kForward).reasons.contains(Reason::step_too_high));
    Terrain pit;
    pit.box(0.40, 0.425, 0.15, 0.175, -0.051);
    EXPECT_TRUE(ask(pit, kForward).reasons.contains(Reason::step_too_low));
}

// The stance height is the mean of both feet, but each foot must keep the limits alone, too.
TEST(Gate, a_foot_that_stood_high_may_not_step_down_by_twice_the_limit) {
    struct Case {
        double left_m, right_m;            // positions of the feet
        double left_then_m, right_then_m;  // positions of the feet after the landing
        Reason reason;
    };
    const Case cases[] = {{0.0, 0.0, 0.0, 0.0, Reason::none},
                          {0.010, -0.010, 0.010, -0.010, Reason::none},
                          {0.010, -0.010, -0.010, 0.010, Reason::none},
                          {0.010, -0.010, -0.0099, -0.010, Reason::none},
                          {0.010, -0.010, -0.0101, -0.010, Reason::step_too_low},
                          {0.0, -0.030, -0.030, -0.030, Reason::step_too_low},
                          {-0.015, 0.015, 0.015, -0.015, Reason::step_too_high}};
    for (const Case& c : cases) {
        Terrain floor;
        floor.box(-1.0, 0.25, 0.0, 1.0, c.left_m).box(-1.0, 0.25, -1.0, 0.0, c.right_m);
        floor.box(0.25, 1.0, 0.0, 1.0, c.left_then_m).box(0.25, 1.0, -1.0, 0.0, c.right_then_m);
        const Verdict verdict = ask(floor, kForward);
        EXPECT_EQ(verdict.decision == Decision::ok, c.reason == Reason::none)
            << c.left_m << " " << c.left_then_m << words(verdict);
        if (c.reason != Reason::none) {
            EXPECT_TRUE(verdict.reasons.contains(c.reason))
                << c.left_m << " " << c.left_then_m << words(verdict);
        }
    }
}

TEST(Gate, given_an_island_at_floor_height_then_disconnected) {
    Terrain gap;
    const auto map = gap.snapshot();
    for (double x = 0.26; x < 0.9; x += 0.025) {
        for (double y = -0.5; y < 0.5; y += 0.025) map->component[cell_at(*map, x, y)] = 7;
    }
    seal(*map);
    expect_refused(ask(*map, kForward), Reason::disconnected);
    map->component[cell_at(*map, 0.0, 0.18)] = 7;  // one cell under a foot connects the surfaces
    seal(*map);
    expect_ok(ask(*map, kForward));
}

}  // namespace
}  // namespace surefoot::gate::testing
