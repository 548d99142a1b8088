// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/motion/trolley_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

TrolleyMotion tour() {
    TrolleyConfig config;
    return TrolleyMotion::trolley(
        {{0.0, 0.0, 0.0, 0.5}, {1.2, 0.3, 0.4, 0.2}, {1.2, 0.3, -0.5, 0.0}, {1.25, 0.3, -0.5, 0.3}},
        config);
}

TEST(TrajectoryTest, DerivativesMatchFiniteDifferences) {
    const TrolleyMotion motion = tour();
    constexpr double kStep_s = 1e-4;
    for (double t_s = 0.01; t_s < motion.duration_s() - 0.01; t_s += 0.0137) {
        const MotionState before = motion.at(t_s - kStep_s);
        const MotionState now = motion.at(t_s);
        const MotionState after = motion.at(t_s + kStep_s);
        const Vector3d velocity =
            (after.T_world_body.translation_m - before.T_world_body.translation_m) /
            (2.0 * kStep_s);
        const Vector3d acceleration =
            (after.velocity_world_m_s - before.velocity_world_m_s) / (2.0 * kStep_s);
        const Vector3d turn =
            log_so3(before.T_world_body.rotation.conjugate() * after.T_world_body.rotation) /
            (2.0 * kStep_s);
        // Jerk is at most 6 V / T^2 = 1.5 m/s^3: a kink of the acceleration within one step.
        constexpr double kKink = 1.5 * kStep_s;
        EXPECT_LT((velocity - now.velocity_world_m_s).norm(), kKink) << "at " << t_s;
        EXPECT_LT((acceleration - now.acceleration_world_m_s2).norm(), kKink) << "at " << t_s;
        EXPECT_LT((turn - now.angular_velocity_body_rad_s).norm(), kKink) << "at " << t_s;
    }
}

TEST(TrajectoryTest, NothingJumpsAndTheSpeedIsKept) {
    const TrolleyMotion motion = tour();
    const TrolleyConfig config;
    constexpr double kStep_s = 1e-3;
    const double largest_acceleration = 1.5 * config.speed_m_s / config.ramp_s;
    double fastest = 0.0;
    for (double t_s = -0.5; t_s < motion.duration_s() + 0.5; t_s += kStep_s) {
        const MotionState a = motion.at(t_s);
        const MotionState b = motion.at(t_s + kStep_s);
        EXPECT_LT((b.T_world_body.translation_m - a.T_world_body.translation_m).norm(),
                  1.01 * config.speed_m_s * kStep_s)
            << "at " << t_s;
        EXPECT_LE((b.velocity_world_m_s - a.velocity_world_m_s).norm(),
                  1.01 * largest_acceleration * kStep_s)
            << "at " << t_s;
        EXPECT_EQ(a.T_world_body.translation_m.z(), config.height_m);
        fastest = std::max(fastest, a.velocity_world_m_s.norm());
    }
    EXPECT_NEAR(fastest, config.speed_m_s, 1e-9);
}

TEST(TrajectoryTest, StartsAndEndsAtItsStops) {
    const TrolleyMotion motion = tour();
    for (const double t_s : {-1.0, 0.0, 0.5}) {
        const Pose T = motion.at(t_s).T_world_body;
        EXPECT_EQ(T.translation_m, Vector3d(0.0, 0.0, 0.95));
        EXPECT_EQ(yaw_rad(T), 0.0);
    }
    const Pose T_end = motion.at(1e3).T_world_body;
    EXPECT_LT((T_end.translation_m - Vector3d(1.25, 0.3, 0.95)).norm(), 1e-12);
    EXPECT_NEAR(yaw_rad(T_end), -0.5, 1e-12);
}

TEST(TrajectoryTest, StandingStaysAndAWayOfNoLengthTakesNoTime) {
    const TrolleyMotion standing = TrolleyMotion::stand({1.0, 2.0, 0.3, 0.0}, 0.9, 4.0);
    EXPECT_EQ(standing.duration_s(), 4.0);
    EXPECT_EQ(standing.at(2.0).T_world_body.translation_m, Vector3d(1.0, 2.0, 0.9));
    EXPECT_EQ(standing.at(2.0).velocity_world_m_s, Vector3d::Zero());
    const TrolleyMotion nowhere =
        TrolleyMotion::trolley({{0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 2.0}}, TrolleyConfig{});
    EXPECT_EQ(nowhere.duration_s(), 3.0);
    EXPECT_TRUE(nowhere.at(1.0).T_world_body.all_finite());
}

}  // namespace
}  // namespace surefoot::sim
