// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/knock.hpp"

#include <gtest/gtest.h>

#include "surefoot/core/angles.hpp"
#include "surefoot/sim/motion/hand_motion.hpp"
#include "surefoot/sim/motion/motion_checks.hpp"

namespace surefoot::sim {
namespace {

const Eigen::Vector3d kCamera_m(0.075, 0.06, 0.05);
const KnockConfig kKnock{2.0, 1.0, -3.0, 2.0};

std::shared_ptr<const Motion> walk() {
    const std::vector<Waypoint> way{{0.0, 0.0, 0.0, 0.2}, {3.0, 0.5, 0.4, 0.5}};
    return std::make_shared<HandMotion>(way, HandConfig{}, 3);
}

TEST(KnockedMotion, DerivativesMatchFiniteDifferences) {
    const KnockedMotion motion(walk(), kKnock, kCamera_m);
    const DerivativeErrors worst = derivative_errors(motion, 1.9, 2.2);
    // 3.7 deg in 0.1 s: snap 60 angle / T^4 * step^2 / 6 and jerks at both ends, 60 angle / T^3.
    EXPECT_LT(worst.velocity_m_s, 2e-5);
    EXPECT_LT(worst.acceleration_m_s2, 3e-2);
    EXPECT_LT(worst.turn_rad_s, 2e-4);
    EXPECT_LT(worst.turn_acceleration_rad_s2, 0.3);
}

TEST(KnockedMotion, TurnsTheCameraWhereItIsAndLeavesTheMachineAlone) {
    const auto machine = walk();
    const KnockedMotion motion(machine, kKnock, kCamera_m);
    const double before_s = kKnock.at_s - 0.01;
    EXPECT_EQ(
        difference(machine->at(before_s).T_world_body, motion.at(before_s).T_world_body).norm(),
        0.0);
    for (const double after_s : {kKnock.at_s + kKnockDuration_s, kKnock.at_s + 5.0}) {
        const Pose T_machine_camera_body =
            machine->at(after_s).T_world_body.inverse() * motion.at(after_s).T_world_body;
        EXPECT_LT((T_machine_camera_body * kCamera_m - kCamera_m).norm(), 1e-12);
        const Eigen::Quaterniond expected(
            Eigen::AngleAxisd(kKnock.yaw_deg * kRadPerDeg, Eigen::Vector3d::UnitZ()) *
            Eigen::AngleAxisd(kKnock.pitch_deg * kRadPerDeg, Eigen::Vector3d::UnitY()) *
            Eigen::AngleAxisd(kKnock.roll_deg * kRadPerDeg, Eigen::Vector3d::UnitX()));
        EXPECT_LT(T_machine_camera_body.rotation.angularDistance(expected), 1e-12);
    }
}

}  // namespace
}  // namespace surefoot::sim
