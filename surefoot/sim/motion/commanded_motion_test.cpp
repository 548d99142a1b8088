// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/motion/commanded_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "surefoot/sim/motion/motion_checks.hpp"
#include "surefoot/sim/scene_source.hpp"

namespace surefoot::sim {
namespace {

constexpr int kForward = 9;
constexpr int kTurnLeft = 25;

std::shared_ptr<CommandedMotion> on_level_ground(const RexStand& start = {}) {
    auto motion = CommandedMotion::make(
        start, [](double, double) { return 0.0; }, {}, 21);
    EXPECT_TRUE(motion.ok());
    return motion.value();
}

TEST(CommandedMotionTest, StandsUntilItIsToldAndStandsAgainAfterEachStep) {
    const auto motion = on_level_ground();
    const Pose start = motion->at(0.0).T_world_body;
    EXPECT_EQ(motion->at(1e4).T_world_body.translation_m, start.translation_m);
    EXPECT_EQ(motion->duration_s(), 0.0);
    const auto first = motion->step(kForward, 3.0);
    ASSERT_TRUE(first.ok()) << first.error().message;
    EXPECT_EQ(motion->at(3.0).T_world_body.translation_m, start.translation_m);
    const Pose after = motion->at(first->end_s + 0.5).T_world_body;
    EXPECT_NEAR(after.translation_m.x() - start.translation_m.x(), 0.40, 1e-6);
    EXPECT_NEAR(after.translation_m.z(), start.translation_m.z(), 1e-6);
    const auto turn = motion->step(kTurnLeft, first->end_s + 2.0);
    ASSERT_TRUE(turn.ok()) << turn.error().message;
    EXPECT_NEAR((motion->at(turn->end_s).T_world_body.translation_m - after.translation_m).norm(),
                0.0,
                2e-3);
    ASSERT_EQ(motion->steps().size(), 2U);
    EXPECT_EQ(motion->steps()[1].command, kTurnLeft);
}

TEST(CommandedMotionTest, ItsPoseAndVelocityNeverJump) {
    const auto motion = on_level_ground({1.0, -2.0, 0.7});
    double time_s = 0.5;
    for (const int command : {kForward, kTurnLeft, 17, 13}) {
        const auto step = motion->step(command, time_s);
        ASSERT_TRUE(step.ok()) << step.error().message;
        time_s = motion->duration_s() + 0.3;
    }
    MotionState before = motion->at(0.0);
    for (double t = 0.001; t < time_s; t += 0.001) {
        const MotionState now = motion->at(t);
        ASSERT_LE((now.T_world_body.translation_m - before.T_world_body.translation_m).norm(), 1e-3)
            << t;
        ASSERT_LE((now.velocity_world_m_s - before.velocity_world_m_s).norm(), 0.02) << t;
        before = now;
    }
}

TEST(CommandedMotionTest, WhatItCannotDoIsRefusedAndChangesNothing) {
    const auto motion = on_level_ground();
    EXPECT_FALSE(motion->step(0, 1.0).ok());
    EXPECT_FALSE(motion->step(27, 1.0).ok());
    const auto step = motion->step(kForward, 1.0);
    ASSERT_TRUE(step.ok());
    const auto during = motion->step(kForward, 5.0);
    ASSERT_FALSE(during.ok());
    EXPECT_NE(during.error().message.find("the last step ends at"), std::string::npos);
    EXPECT_EQ(motion->steps().size(), 1U);
    EXPECT_TRUE(motion->step(kForward, motion->duration_s()).ok());
}

TEST(CommandedMotionTest, WhatIsForgottenChangesNothingAfterIt) {
    const auto whole = on_level_ground();
    const auto cut = on_level_ground();
    double time_s = 0.5;
    std::size_t most = 0;
    for (int k = 0; k < 12; ++k) {
        const int command = k % 3 == 0 ? kTurnLeft : kForward;
        const auto step = whole->step(command, time_s);
        ASSERT_TRUE(step.ok());
        ASSERT_TRUE(cut->step(command, time_s).ok());
        cut->forget_before(step->start_s);
        most = std::max(most, cut->steps().size());
        for (double t = step->start_s; t < whole->duration_s() + 1.0; t += 0.05) {
            EXPECT_EQ(cut->at(t).T_world_body.translation_m,
                      whole->at(t).T_world_body.translation_m);
            EXPECT_EQ(cut->at(t).velocity_world_m_s, whole->at(t).velocity_world_m_s);
        }
        time_s = whole->duration_s() + 0.3;
    }
    EXPECT_EQ(whole->steps().size(), 12U);
    EXPECT_EQ(most, 1U);
    const Pose end = whole->at(time_s).T_world_body;
    cut->forget_before(time_s);
    EXPECT_TRUE(cut->steps().empty());
    EXPECT_EQ(cut->at(time_s).T_world_body.translation_m, end.translation_m);
    EXPECT_LT((cut->at(0.0).T_world_body.translation_m - end.translation_m).norm(), 0.41)
        << "before what is left it is where that begins";
}

TEST(CommandedMotionTest, ItsJointsAreThoseOfTheStepThatItMakes) {
    const auto motion = on_level_ground();
    const auto knees = [&](double time_s) {
        const auto joints = motion->rex_joints(time_s);
        EXPECT_TRUE(joints.has_value()) << "at " << time_s;
        return joints ? std::max(joints->left.knee_rad, joints->right.knee_rad) : 0.0;
    };
    const double standing_rad = knees(0.0);
    const auto step = motion->step(kForward, 3.0);
    ASSERT_TRUE(step.ok()) << step.error().message;
    double most_rad = 0.0;
    for (double t = step->start_s; t < step->end_s; t += 0.1)
        most_rad = std::max(most_rad, knees(t));
    EXPECT_NEAR(knees(2.9), standing_rad, 1e-9);
    EXPECT_GT(most_rad, standing_rad + 0.2);
    EXPECT_NEAR(knees(step->end_s + 0.5), standing_rad, 1e-6);
}

TEST(CommandedMotionTest, ASceneIsWalkedAsTheCommandsComeAndNothingOfItPiles) {
    SceneOptions options;
    options.scene = "walk_floor";
    options.sensor = Sensor::analytic;
    options.commanded = true;
    options.rate_hz = 5.0;
    auto source = open_scene(options, nullptr);
    ASSERT_TRUE(source.ok()) << source.error().message;
    ASSERT_NE((*source)->commanded(), nullptr);
    EXPECT_FALSE((*source)->info().frames.has_value()) << "nobody knows the end";
    Pose first;
    for (int i = 0; i < 100; ++i) {
        const auto frame = (*source)->next();
        ASSERT_TRUE(frame.ok() && frame->has_value()) << i;
        // The motion may go on for hours.
        ASSERT_EQ((*source)->truth().trajectory.size(), 1U);
        EXPECT_EQ((*source)->truth().trajectory.back().time_ns, (*frame)->time_ns);
        if (i == 0) first = (*source)->truth().trajectory.back().T_world_body;
        if (i == 10) {
            EXPECT_EQ((*source)->truth().trajectory.back().T_world_body.translation_m,
                      first.translation_m);
            ASSERT_TRUE((*source)->commanded()->step(kForward, (*source)->now_s()).ok());
        }
    }
    const Pose last = (*source)->truth().trajectory.back().T_world_body;
    EXPECT_NEAR((last.translation_m - first.translation_m).norm(), 0.40, 0.02);
}

}  // namespace
}  // namespace surefoot::sim
