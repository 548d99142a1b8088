// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/goal.hpp"

#include <gtest/gtest.h>

#include "surefoot/core/unknown.hpp"
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

TEST(Goal, one_that_nobody_filled_in_is_the_origin_without_a_heading) {
    const GoalPose goal;
    EXPECT_EQ(goal.x_tenth_mm, 0);
    EXPECT_EQ(goal.y_tenth_mm, 0);
    Terrain floor;
    const auto map = floor.snapshot();
    const Verdict verdict = judge_goal(rex(), query_at_body(0, *map), goal, *map, kReady, kNowNs);
    EXPECT_EQ(verdict.primary, Reason::bad_number) << words(verdict);
}

TEST(Goal, a_table_top_is_level_and_out_of_reach) {
    Terrain table;
    table.box(0.8, 2.6, -1.6, 0.2, 0.72);
    const auto map = table.snapshot();
    const Verdict verdict = point_at(*map, 1.7, -0.7);
    EXPECT_EQ(verdict.decision, Decision::not_traversable) << words(verdict);
    EXPECT_EQ(verdict.primary, Reason::disconnected) << words(verdict);
    EXPECT_TRUE(verdict.evidence.has_worst_cell);
    // A surface is connected or not: there is no length.
    EXPECT_EQ(verdict.evidence.value_tenth_mm, 0);
    EXPECT_EQ(verdict.evidence.limit_tenth_mm, 0);
    EXPECT_EQ(point_at(*map, -1.5, 1.0).decision, Decision::ok);
}

TEST(Goal, what_hangs_over_an_edge_or_was_never_seen_does_not_carry) {
    Terrain edge;
    edge.box(1.5, 3.0, -3.0, 3.0, -0.3);
    const auto map = edge.snapshot();
    EXPECT_EQ(point_at(*map, 1.4, 0.0).decision, Decision::not_traversable);
    Terrain unseen;
    unseen.box(1.0, 2.0, -1.0, 1.0, static_cast<double>(kNanF));
    EXPECT_EQ(point_at(*unseen.snapshot(), 1.5, 0.0).primary, Reason::unknown_cells);
    EXPECT_EQ(point_at(*map, 50.0, 0.0).primary, Reason::outside_map);
}

TEST(Goal, where_the_machine_stands_must_be_known) {
    Terrain blind;
    blind.box(-0.7, 0.7, -0.7, 0.7, static_cast<double>(kNanF));
    const Verdict verdict = point_at(*blind.snapshot(), 1.5, -1.0);
    EXPECT_EQ(verdict.primary, Reason::disconnected) << words(verdict);
    EXPECT_FALSE(verdict.evidence.has_worst_cell) << "it is not about the goal";
}

TEST(Goal, damage_where_the_machine_stands_is_an_error_though_the_goal_is_elsewhere) {
    Terrain floor;
    const auto map = floor.snapshot();
    map->height_tenth_mm[cell_at(*map, 0.1, 0.18)] ^= 1;
    const Verdict verdict = point_at(*map, 0.0, 2.0);
    EXPECT_EQ(verdict.decision, Decision::error) << words(verdict);
    EXPECT_EQ(verdict.reasons, ReasonSet(Reason::internal)) << words(verdict);
}

TEST(Goal, attested_ground_belongs_to_where_the_machine_stands) {
    Terrain blind;
    blind.box(-0.9, 0.9, -0.9, 0.9, static_cast<double>(kNanF));
    const auto map = blind.snapshot();
    Query here = query_at_body(0, *map);
    here.attested = {true, 0, 0, 10'000, 0};
    const GoalPose near{500, -300, 1.0, 0.0};
    EXPECT_EQ(judge_goal(rex(), here, near, *map, kReady, kNowNs).decision, Decision::ok);
    here.attested.active = false;
    EXPECT_EQ(judge_goal(rex(), here, near, *map, kReady, kNowNs).primary, Reason::unknown_cells);
}

TEST(Goal, is_judged_at_its_own_place_heading_and_height) {
    Terrain room;
    room.box(1.6, 2.6, -3.0, 3.0, 0.01);
    const auto map = room.snapshot();
    Query here = query_at_body(0, *map);
    here.stance_source = StanceHeight::given;  // the goal may have another height
    here.stance_height_tenth_mm = -30;
    const GoalPose there{21'000, -4'000, 0.0, 1.0};
    const Verdict verdict = judge_goal(rex(), here, there, *map, kReady, kNowNs);
    EXPECT_EQ(verdict.decision, Decision::ok) << words(verdict);
    EXPECT_EQ(verdict.evidence.stance_height_tenth_mm, 100);

    // A post beside a machine that faces +x, in the way of a machine that faces -y.
    Terrain post;
    post.box(1.97, 2.0, -0.56, -0.53, 0.5);
    const auto with_post = post.snapshot();
    Machine longer = rex();
    longer.body.parts[0].box.length_tenth_mm = 12'000;
    const auto looking = [&](double cos_yaw, double sin_yaw) {
        return judge_goal(longer,
                          query_at_body(0, *with_post),
                          {20'000, 0, cos_yaw, sin_yaw},
                          *with_post,
                          kReady,
                          kNowNs)
            .decision;
    };
    EXPECT_EQ(looking(1.0, 0.0), Decision::ok);
    EXPECT_EQ(looking(0.0, -1.0), Decision::not_traversable);
}

TEST(Goal, works_where_every_movement_is_off) {
    Terrain floor;
    const auto map = floor.snapshot();
    Machine still = rex();
    still.movements = {};
    still.limits.step[0].enabled = false;
    const Verdict verdict =
        judge_goal(still, query_at_body(0, *map), {0, 0, 1.0, 0.0}, *map, kReady, kNowNs);
    EXPECT_EQ(verdict.decision, Decision::ok) << words(verdict);
    EXPECT_EQ(verdict.valid_until_ns, verdict.decided_ns);
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
