// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/motion/motion_script.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "surefoot/sim/motion/motion_checks.hpp"
#include "surefoot/sim/motion/motion_scripts.hpp"
#include "surefoot/sim/motion/rex_kinematics.hpp"

namespace surefoot::sim {
namespace {

constexpr double kPi = std::numbers::pi;

ScriptedMotion made(const MotionScript& script, std::uint64_t seed = 1) {
    auto motion = make_motion(script, seed);
    EXPECT_TRUE(motion.ok()) << motion.error().message;
    return *motion;
}

std::string refusal(const MotionScript& script) {
    const auto motion = make_motion(script, 1);
    if (motion.ok()) return "accepted";
    EXPECT_EQ(motion.error().code, ErrorCode::usage);
    return motion.error().message;
}

TEST(MotionScriptTest, ImpossibleScriptsAreRefusedInWords) {
    MotionScript script;
    EXPECT_EQ(refusal(script), "simulator: a motion has no waypoint; add at least one");
    script.waypoints = {{}, {std::numeric_limits<double>::quiet_NaN(), 0.0}};
    EXPECT_NE(refusal(script).find("waypoint 1 is at x nan"), std::string::npos);
    script.waypoints = {{0.0, 0.0, 0.0, -1.0}};
    EXPECT_NE(refusal(script).find("waypoint 0 has pause_s -1"), std::string::npos);
    script.waypoints = {{}, {0.3, 0.0, 0.0, 0.0, 0.18}};
    EXPECT_NE(refusal(script).find("rises by 0.180 m over 0.300 m"), std::string::npos);
    script.motion_model = MotionModel::hand;
    EXPECT_EQ(refusal(script), "accepted") << "who carries it climbs stairs";
    script.waypoints[1].ground_z_m = 0.36;
    EXPECT_NE(refusal(script).find("rises by 0.360 m over 0.300 m; motion_model hand climbs 1:1"),
              std::string::npos);
    script.waypoints[1].ground_z_m = 0.18;
    script.motion_model = MotionModel::rex;
    EXPECT_EQ(refusal(script), "accepted") << "stairs are for feet";
    script.waypoints[1].ground_z_m = 0.5;
    EXPECT_NE(refusal(script).find("limit is 0.20 m"), std::string::npos);
    script.speed_m_s = 1.0;
    EXPECT_NE(refusal(script).find("speed_m_s is 1; motion_model rex moves at 0.02 to 0.1"),
              std::string::npos);
}

TEST(MotionScriptTest, StepEventsTellWhatTheMachineDoes) {
    const ScriptedMotion walk = made(pivot_and_reverse_script(MotionModel::rex, 1.0));
    ASSERT_EQ(walk.steps.size(), 10U) << "six turns, four steps back";
    for (std::size_t i = 0; i < walk.steps.size(); ++i) {
        const StepEvent& step = walk.steps[i];
        EXPECT_EQ(step.command, i < 6 ? 25 : 17);
        EXPECT_NEAR(step.end_s - step.start_s, 10.0, 1e-9);
        for (const auto& [time_s, T] :
             {std::pair(step.start_s, step.T_world_before), {step.end_s, step.T_world_after}})
            EXPECT_LT(difference(walk.motion->at(time_s).T_world_body, T).norm(), 1e-9);
        if (i > 0) {
            EXPECT_LE(walk.steps[i - 1].end_s, step.start_s);
            EXPECT_EQ(walk.steps[i - 1].T_world_after.translation_m,
                      step.T_world_before.translation_m);
        }
    }
    EXPECT_EQ(walk.steps.front().start_s, 1.0);
    EXPECT_TRUE(made(approach_script(MotionModel::hand, 2.0)).steps.empty());
}

TEST(MotionScriptTest, ATrolleyStopsWhereItPauses) {
    MotionScript script;
    script.waypoints = {{0.0, 0.0, 0.0, 1.0}, {0.5, 0.0, 0.0, 0.0}, {0.5, 0.0, 0.2, 0.5}};
    const ScriptedMotion drive = made(script);
    ASSERT_EQ(drive.stops.size(), 2U) << "no pause, no stop";
    EXPECT_EQ(drive.stops[0].start_s, 0.0);
    EXPECT_NEAR(drive.stops[1].start_s, drive.motion->duration_s() - 0.5, 1e-9);
    for (const Stop& stop : drive.stops) {
        EXPECT_EQ(drive.motion->at(stop.start_s).velocity_world_m_s.norm(), 0.0);
        EXPECT_EQ(
            difference(drive.motion->at(stop.start_s + 0.4).T_world_body, stop.T_world_body).norm(),
            0.0);
    }
    EXPECT_TRUE(drive.steps.empty());
    EXPECT_TRUE(made(approach_script(MotionModel::hand, 2.0)).stops.empty());
    EXPECT_TRUE(made(approach_script(MotionModel::rex, 2.0)).stops.empty());
}

TEST(MotionScriptTest, TheSpeedOfARexIsThatOfItsSteps) {
    MotionScript script = approach_script(MotionModel::rex, 0.8);
    script.speed_m_s = 0.05;
    const ScriptedMotion walk = made(script);
    EXPECT_NEAR(walk.steps[0].end_s - walk.steps[0].start_s, 8.0, 1e-9);
}

TEST(MotionScriptTest, EverydayScriptsEndWhereTheySay) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const auto end = [&](const MotionScript& script) {
            return made(script, seed).motion->at(1e6).T_world_body;
        };
        const auto near = [](const Pose& T, double x_m, double y_m, double yaw) {
            return std::hypot(T.translation_m.x() - x_m, T.translation_m.y() - y_m) < 0.15 &&
                   std::abs(std::remainder(yaw_rad(T) - yaw, 2.0 * kPi)) < 0.14;
        };
        EXPECT_TRUE(near(end(approach_script(MotionModel::rex, 2.4)), 2.4, 0.0, 0.0));
        EXPECT_TRUE(near(end(turn_round_script(MotionModel::rex, kPi)), 0.0, 0.0, 0.0));
        EXPECT_TRUE(near(end(back_to_table_script(MotionModel::rex, 2.5, 1.5)), 2.05, 0.0, kPi));
        EXPECT_TRUE(near(end(sidestep_through_door_script(MotionModel::rex, 2.5, 0.1, 0.6)),
                         3.1,
                         0.1,
                         -0.5 * kPi));
        EXPECT_TRUE(
            near(end(pivot_and_reverse_script(MotionModel::rex, 1.0)), 0.0, -1.0, 0.5 * kPi));
    }
}

TEST(MotionScriptTest, DescendsBackwardOntoTheFirstTread) {
    const double edge_m = descending_edge_x_m(4);
    const auto stairs = [&](double x_m, double) { return x_m > edge_m ? -0.18 : 0.0; };
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const auto walk = make_motion(descend_backwards_script(4, 0.18), seed, stairs);
        ASSERT_TRUE(walk.ok()) << walk.error().message;
        const auto& steps = walk->steps;
        EXPECT_NEAR(steps.back().T_world_after.translation_m.z(), rex::kStand_m - 0.18, 1e-9);
        EXPECT_NEAR(steps[steps.size() - 2].T_world_after.translation_m.z(), rex::kStand_m, 1e-9);
        const double on_tread_m = steps.back().T_world_after.translation_m.x() - edge_m;
        EXPECT_GT(on_tread_m, 0.15) << "seed " << seed;
        EXPECT_LT(on_tread_m, 0.31) << "seed " << seed;
    }
}

TEST(MotionScriptTest, TheSameSeedGivesTheSameMotion) {
    for (const MotionModel motion_model :
         {MotionModel::trolley, MotionModel::rex, MotionModel::hand}) {
        const MotionScript script = approach_script(motion_model, 1.2);
        const ScriptedMotion a = made(script, 3);
        const ScriptedMotion b = made(script, 3);
        const ScriptedMotion c = made(script, 4);
        double apart_m = 0.0;
        for (double t_s = 0.0; t_s < a.motion->duration_s(); t_s += 0.1) {
            EXPECT_EQ(a.motion->at(t_s).T_world_body.translation_m,
                      b.motion->at(t_s).T_world_body.translation_m);
            apart_m = std::max(apart_m,
                               (a.motion->at(t_s).T_world_body.translation_m -
                                c.motion->at(t_s).T_world_body.translation_m)
                                   .norm());
        }
        EXPECT_GT(apart_m, 1e-3);
        EXPECT_EQ(a.motion->at(0.0).T_world_body.translation_m,
                  c.motion->at(0.0).T_world_body.translation_m)
            << "the start never moves";
    }
}

TEST(MotionScriptTest, ATrolleyFollowsARampSmoothly) {
    MotionScript script;
    script.waypoints = {
        {0.0, 0.0, 0.0, 0.5}, {1.0, 0.0}, {3.0, 0.0, 0.0, 0.0, 0.25}, {4.0, 0.3, 0.8, 0.5, 0.25}};
    const ScriptedMotion drive = made(script);
    const DerivativeErrors worst =
        derivative_errors(*drive.motion, 0.01, drive.motion->duration_s() - 0.01);
    // Jerk: the trolley's 1.5 m/s^3 (as in its own test).
    EXPECT_LT(worst.velocity_m_s, 1.5e-4);
    EXPECT_LT(worst.acceleration_m_s2, 1.5e-4);
    EXPECT_LT(worst.turn_rad_s, 1.5e-4);
    EXPECT_LT(worst.turn_acceleration_rad_s2, 1.5e-4);
    double steepest_rad = 0.0;
    for (double t_s = 0.0; t_s < drive.motion->duration_s(); t_s += 0.05) {
        const Pose T = drive.motion->at(t_s).T_world_body;
        steepest_rad = std::max(steepest_rad, std::asin(T.R()(2, 0)));
        if (T.translation_m.x() > 1.4 && T.translation_m.x() < 2.6) {
            // 0.25 m over 2 m less one blend of 0.3 m.
            EXPECT_NEAR(std::asin(T.R()(2, 0)), std::atan(0.25 / 1.7), 1e-3) << "nose up";
        }
    }
    EXPECT_LT(steepest_rad, std::atan(0.25 / 1.7) + 1e-3);
    EXPECT_NEAR(drive.motion->at(1e3).T_world_body.translation_m.z(), 1.2, 1e-12);
}

}  // namespace
}  // namespace surefoot::sim
