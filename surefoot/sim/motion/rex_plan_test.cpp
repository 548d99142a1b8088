// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/motion/rex_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <set>
#include <string>

namespace surefoot::sim {
namespace {

constexpr double kPi = std::numbers::pi;

RexPlan planned(const std::vector<Waypoint>& stops, std::uint64_t seed = 1) {
    Rng rng(seed);
    auto plan = plan_rex_steps(stops, {}, rng);
    EXPECT_TRUE(plan.ok()) << plan.error().message;
    return *plan;
}

std::set<int> codes(const RexPlan& plan) {
    std::set<int> used;
    for (const RexStep& step : plan.steps) used.insert(step.movement.command);
    return used;
}

Waypoint by(Move move, double x_m, double y_m, double yaw_rad) {
    return {x_m, y_m, yaw_rad, 0.0, 0.0, move};
}

TEST(RexPlanTest, MovementsAreThoseOfTheMachineFile) {
    std::ifstream file(SUREFOOT_SOURCE_DIR "/machines/rex.yaml");
    ASSERT_TRUE(file.is_open()) << SUREFOOT_SOURCE_DIR;
    const auto movements = rex_movements({});
    int found = 0;
    for (std::string line; std::getline(file, line);) {
        int code = 0;
        char name[16];
        double forward_m = 0.0;
        double left_m = 0.0;
        double turn_deg = 0.0;
        if (std::sscanf(line.c_str(),
                        " - {code: %d, name: %15[^,], forward_m: %lf, left_m: %lf, turn_deg: %lf",
                        &code,
                        name,
                        &forward_m,
                        &left_m,
                        &turn_deg) != 5)
            continue;
        const auto movement = std::find_if(
            movements.begin(), movements.end(), [&](const auto& m) { return m.command == code; });
        ASSERT_NE(movement, movements.end()) << "code " << code;
        // The file rounds to whole millimetres.
        EXPECT_NEAR(movement->forward_m, forward_m, 0.00051) << "code " << code;
        EXPECT_NEAR(movement->left_m, left_m, 0.00051) << "code " << code;
        EXPECT_NEAR(movement->turn_rad * 180.0 / kPi, turn_deg, 1e-9) << "code " << code;
        ++found;
    }
    EXPECT_EQ(found, static_cast<int>(movements.size()));
}

TEST(RexPlanTest, ReachesWaypointsWithinHalfAStepAndHalfATurn) {
    Rng rng(9);
    for (int i = 0; i < 200; ++i) {
        const Waypoint goal = by(
            static_cast<Move>(i % 4), rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(-9, 9));
        const RexPlan plan = planned({{}, goal}, static_cast<std::uint64_t>(i));
        const RexStand end = plan.steps.empty() ? plan.start : plan.steps.back().after;
        EXPECT_LE(std::hypot(end.x_m - goal.x_m, end.y_m - goal.y_m), 0.2) << "case " << i;
        EXPECT_LE(std::abs(std::remainder(end.yaw_rad - goal.yaw_rad, 2.0 * kPi)),
                  7.5 * kPi / 180.0 + 1e-9)
            << "case " << i;
    }
}

TEST(RexPlanTest, StepsChainAndLandCloseToTheCommand) {
    const RexPlan plan = planned({{}, by(Move::automatic, 2.0, 1.0, 1.0)});
    RexStand now = plan.start;
    for (const RexStep& step : plan.steps) {
        EXPECT_EQ(step.before.x_m, now.x_m);
        EXPECT_EQ(step.before.yaw_rad, now.yaw_rad);
        const RexStand nominal = moved(step.before, step.movement, 1.0);
        EXPECT_LT(std::hypot(step.after.x_m - nominal.x_m, step.after.y_m - nominal.y_m), 0.016)
            << "five sigma";
        EXPECT_NE(step.after.x_m, nominal.x_m) << "no machine lands exactly";
        now = step.after;
    }
}

TEST(RexPlanTest, TakesTheShorterWayOrTheOneAskedFor) {
    EXPECT_EQ(codes(planned({{}, by(Move::automatic, 1.2, 0.0, 0.0)})), std::set<int>{9});
    EXPECT_EQ(codes(planned({{}, by(Move::automatic, -0.5, 0.0, 0.0)})), std::set<int>{17});
    EXPECT_EQ(codes(planned({{}, by(Move::automatic, 0.0, 0.3, 0.0)})), std::set<int>{21});
    EXPECT_EQ(codes(planned({{}, by(Move::side, 0.0, -1.0, 0.0)})), std::set<int>{13});
    // Ten steps back, or turn and walk: the script asks for steps back.
    const std::set<int> back = codes(planned({{}, by(Move::back, -2.5, 0.0, 0.0)}));
    EXPECT_EQ(back.count(25) + back.count(26), 0U);
    EXPECT_EQ(back.count(17), 1U);
    const std::set<int> ahead = codes(planned({{}, by(Move::ahead, -0.8, 0.0, 0.0)}));
    EXPECT_EQ(ahead.count(9), 1U);
    EXPECT_EQ(ahead.count(25) + ahead.count(26), 1U);
}

TEST(RexPlanTest, WaitsWhereTheWaypointsSay) {
    const RexPlan plan =
        planned({{0.0, 0.0, 0.0, 3.0}, {0.4, 0.0, 0.0, 2.0}, {0.8, 0.0, 0.0, 1.0}});
    ASSERT_EQ(plan.steps.size(), 2U);
    EXPECT_EQ(plan.steps[0].wait_s, 3.0);
    EXPECT_EQ(plan.steps[1].wait_s, 2.0);
    EXPECT_EQ(plan.last_wait_s, 1.0);
    const RexPlan standing = planned({{0.0, 0.0, 0.0, 3.0}});
    EXPECT_TRUE(standing.steps.empty());
    EXPECT_EQ(standing.last_wait_s, 3.0);
}

TEST(RexPlanTest, AWayWithoutEndIsRefused) {
    Rng rng(1);
    const auto plan = plan_rex_steps({{}, by(Move::side, 900.0, 0.0, 0.0)}, {}, rng);
    ASSERT_FALSE(plan.ok());
    EXPECT_NE(plan.error().message.find("waypoint 1 takes 2000 steps or more"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::sim
