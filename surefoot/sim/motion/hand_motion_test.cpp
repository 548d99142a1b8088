// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/motion/hand_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "surefoot/sim/motion/motion_checks.hpp"

namespace surefoot::sim {
namespace {

const std::vector<Waypoint> kWay{
    {0.0, 0.0, 0.0, 2.0}, {6.0, 0.0, 0.3, 1.0}, {8.0, 3.0, 1.2, 1.5, 0.2}};

TEST(HandMotionTest, DerivativesMatchFiniteDifferences) {
    const HandMotion motion(kWay, {}, 3);
    const DerivativeErrors worst = derivative_errors(motion, 0.0, motion.duration_s());
    // The trolley's jerk of 6 V / T^2 = 9.4 m/s^3 and that of an envelope's kinks, together below
    // 30 m/s^3: half a step of 1e-4 s of it.
    EXPECT_LT(worst.velocity_m_s, 1e-5);
    EXPECT_LT(worst.acceleration_m_s2, 1.5e-3);
    EXPECT_LT(worst.turn_rad_s, 1e-5);
    EXPECT_LT(worst.turn_acceleration_rad_s2, 3e-3);
}

TEST(HandMotionTest, BobsLikeAWalkerAndStandsAtBothEnds) {
    const HandConfig config;
    const HandMotion motion(kWay, config, 3);
    const Pose T_start = motion.at(-1.0).T_world_body;
    EXPECT_LT((T_start.translation_m - Eigen::Vector3d(0.0, 0.0, config.height_m)).norm(), 1e-12);
    EXPECT_EQ(motion.at(0.0).velocity_world_m_s.norm(), 0.0);
    const Pose T_end = motion.at(1e3).T_world_body;
    EXPECT_LT((T_end.translation_m - Eigen::Vector3d(8.0, 3.0, config.height_m + 0.2)).norm(),
              1e-9);
    EXPECT_NEAR(yaw_rad(T_end), 1.2, 1e-9);
    // In the middle of the first way, at full speed.
    double high_m = 0.0;
    double low_m = 9.0;
    double up_m_s2 = 0.0;
    double tilt_rad = 0.0;
    int crossings = 0;
    double before = 0.0;
    for (double t_s = 4.0; t_s < 7.0; t_s += 0.005) {
        const MotionState state = motion.at(t_s);
        const double z_m = state.T_world_body.translation_m.z();
        high_m = std::max(high_m, z_m);
        low_m = std::min(low_m, z_m);
        up_m_s2 = std::max(up_m_s2, state.acceleration_world_m_s2.z());
        tilt_rad = std::max(tilt_rad, std::acos(state.T_world_body.R()(2, 2)));
        crossings += before * state.acceleration_world_m_s2.z() < 0.0 ? 1 : 0;
        before = state.acceleration_world_m_s2.z();
    }
    EXPECT_GT(high_m - low_m, 0.028);
    EXPECT_LT(high_m - low_m, 0.055) << "bob and slow drift";
    EXPECT_GT(up_m_s2, 1.4);
    EXPECT_LT(up_m_s2, 2.9);
    EXPECT_LT(tilt_rad, 6.0 * 3.14159 / 180.0);
    EXPECT_GE(crossings, 10) << "3 s at 1.8-2 Hz cross zero 10.8-12 times";
    EXPECT_LE(crossings, 13);
}

TEST(HandMotionTest, TheSeedChangesTheHandNotTheWay) {
    const HandMotion a(kWay, {}, 3);
    const HandMotion b(kWay, {}, 3);
    const HandMotion c(kWay, {}, 4);
    EXPECT_EQ(a.duration_s(), c.duration_s());
    EXPECT_EQ(a.at(5.0).T_world_body.translation_m, b.at(5.0).T_world_body.translation_m);
    const double apart_m =
        (a.at(5.0).T_world_body.translation_m - c.at(5.0).T_world_body.translation_m).norm();
    EXPECT_GT(apart_m, 1e-4);
    EXPECT_LT(apart_m, 0.1);
}

}  // namespace
}  // namespace surefoot::sim
