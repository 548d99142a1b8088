// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/motion/rex_kinematics.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "surefoot/core/rng.hpp"
#include "surefoot/sim/motion/gait_trace.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

TEST(RexKinematicsTest, StraightLegsStandAsTheDataSheetSays) {
    const Pose T = pelvis_to_sole(Side::left, {});
    EXPECT_LT((T.translation_m - Vector3d(rex::kHip_x_m, 0.235, -0.990)).norm(), 1e-12);
    const Pose flexed = pelvis_to_sole(Side::right, {0.0, 0.0, -0.5, 0.0, 0.0, 0.0});
    EXPECT_GT(flexed.translation_m.x(), 0.4) << "a flexed hip brings the foot ahead";
    const Pose bent = pelvis_to_sole(Side::right, {0.0, 0.0, 0.0, 0.5, 0.0, 0.0});
    EXPECT_LT(bent.translation_m.x(), -0.1) << "a flexed knee brings the foot back";
}

TEST(RexKinematicsTest, InverseReturnsTheAnglesOfAnyLeg) {
    Rng rng(3);
    for (int i = 0; i < 2000; ++i) {
        const Side side = i % 2 == 0 ? Side::left : Side::right;
        const LegAngles q{rng.uniform(-0.5, 0.5),
                          rng.uniform(-0.4, 0.4),
                          rng.uniform(-1.5, 0.3),
                          rng.uniform(0.01, 1.6),
                          rng.uniform(-0.4, 0.3),
                          rng.uniform(-0.2, 0.2)};
        const auto back = leg_angles(side, pelvis_to_sole(side, q));
        ASSERT_TRUE(back.has_value()) << "case " << i;
        EXPECT_NEAR(back->hip_rotation_rad, q.hip_rotation_rad, 1e-9) << "case " << i;
        EXPECT_NEAR(back->hip_roll_rad, q.hip_roll_rad, 1e-9) << "case " << i;
        EXPECT_NEAR(back->hip_pitch_rad, q.hip_pitch_rad, 1e-9) << "case " << i;
        EXPECT_NEAR(back->knee_rad, q.knee_rad, 1e-9) << "case " << i;
        EXPECT_NEAR(back->ankle_pitch_rad, q.ankle_pitch_rad, 1e-9) << "case " << i;
        EXPECT_NEAR(back->ankle_roll_rad, q.ankle_roll_rad, 1e-9) << "case " << i;
    }
}

TEST(RexKinematicsTest, TheTraceStandsWhereTheConstantsSay) {
    const LinkAngles& leg = gait_trace().front().left;
    LegAngles q;
    q.hip_pitch_rad = leg.upper_leg_rad;
    q.knee_rad = leg.lower_leg_rad - leg.upper_leg_rad;
    q.ankle_pitch_rad = leg.foot_rad - kFlatFoot_rad - leg.lower_leg_rad;
    const Pose T = pelvis_to_sole(Side::left, q);
    EXPECT_LT((T.translation_m - Vector3d(0.0, rex::kHip_y_m, -rex::kStand_m)).norm(), 1e-4);
    EXPECT_LT(log_so3(T.rotation).norm(), 1e-9) << "the sole is flat";
}

TEST(RexKinematicsTest, WhatIsTooFarHasNoAngles) {
    Pose T;
    T.translation_m = {rex::kHip_x_m, rex::kHip_y_m, -0.991};
    EXPECT_FALSE(leg_angles(Side::left, T).has_value());
    T.translation_m.z() = -0.989;
    EXPECT_TRUE(leg_angles(Side::left, T).has_value());
    T.translation_m.z() = 0.3;  // a foot over the hip
    EXPECT_FALSE(leg_angles(Side::left, T).has_value());
}

TEST(RexKinematicsTest, JointRangesNameTheJoint) {
    EXPECT_FALSE(joint_problem(Side::left, {}).has_value());
    LegAngles q;
    q.hip_roll_rad = 0.3;  // 17 deg: outward on the left, inward on the right
    EXPECT_FALSE(joint_problem(Side::left, q).has_value());
    EXPECT_EQ(joint_problem(Side::right, q),
              "right hip abduction would be -17.2 deg; the joint allows -16 to 20 deg");
    q = {};
    q.ankle_pitch_rad = -0.4;
    EXPECT_EQ(joint_problem(Side::left, q),
              "left ankle dorsiflexion would be 22.9 deg; the joint allows -10 to 20 deg");
}

}  // namespace
}  // namespace surefoot::sim
