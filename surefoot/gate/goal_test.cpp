// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/goal.hpp"

#include <gtest/gtest.h>

#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate::testing {
namespace {

Verdict point_at(const grid::MapSnapshot& map, double x_m, double y_m) {
    const GoalPose goal{
        static_cast<std::int64_t>(x_m * 1e4), static_cast<std::int64_t>(y_m * 1e4), 0.8, 0.6};
    return judge_goal(rex(), query_at_body(0, map), goal, map, kReady, kNowNs);
}

TEST(Goal, level_ground_carries_and_is_still_no_permission) {
    Terrain floor;
    const auto map = floor.snapshot();
    const Verdict verdict = point_at(*map, 1.5, -1.0);
    EXPECT_EQ(verdict.decision, Decision::ok) << words(verdict);
    EXPECT_EQ(verdict.command, 0);
    for (const std::int64_t later : {std::int64_t{-1}, std::int64_t{0}, std::int64_t{1}})
        EXPECT_FALSE(verdict.allows_step(kNowNs + later));
}

TEST(Goal, a_table_top_is_level_and_out_of_reach) {
    Terrain table;
    table.box(0.8, 2.6, -1.6, 0.2, 0.72);
    const auto map = table.snapshot();
    const Verdict verdict = point_at(*map, 1.7, -0.7);
    EXPECT_EQ(verdict.decision, Decision::not_traversable) << words(verdict);
    EXPECT_EQ(verdict.primary, Reason::disconnected) << words(verdict);
    EXPECT_TRUE(verdict.evidence.has_worst_cell);
    EXPECT_EQ(point_at(*map, -1.5, 1.0).decision, Decision::ok);
}

TEST(Goal, what_hangs_over_an_edge_or_was_never_seen_does_not_carry) {
    Terrain edge;
    edge.box(1.5, 3.0, -3.0, 3.0, -0.3);
    const auto map = edge.snapshot();
    EXPECT_EQ(point_at(*map, 1.4, 0.0).decision, Decision::not_traversable);
    Terrain unseen;
    unseen.box(1.0, 2.0, -1.0, 1.0, static_cast<double>(kNaN));
    EXPECT_EQ(point_at(*unseen.snapshot(), 1.5, 0.0).primary, Reason::unknown_cells);
    EXPECT_EQ(point_at(*map, 50.0, 0.0).primary, Reason::outside_map);
}

TEST(Goal, where_the_machine_stands_must_be_known) {
    Terrain blind;
    blind.box(-0.7, 0.7, -0.7, 0.7, static_cast<double>(kNaN));
    const Verdict verdict = point_at(*blind.snapshot(), 1.5, -1.0);
    EXPECT_EQ(verdict.primary, Reason::disconnected) << words(verdict);
}

TEST(Goal, a_gate_that_cannot_judge_says_so) {
    Terrain floor;
    const auto map = floor.snapshot();
    const Query here = query_at_body(0, *map);
    EXPECT_EQ(judge_goal(rex(), here, GoalPose{}, *map, kReady, kNowNs).primary,
              Reason::bad_number);
    EXPECT_EQ(judge_goal(rex(), here, {0, 0, 1.0, 0.0}, *map, GateHealth{}, kNowNs).primary,
              Reason::not_ready);
    EXPECT_EQ(judge_goal(Machine{}, here, {0, 0, 1.0, 0.0}, *map, kReady, kNowNs).primary,
              Reason::config);
}

}  // namespace
}  // namespace surefoot::gate::testing
