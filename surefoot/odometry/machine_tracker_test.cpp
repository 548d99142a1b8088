// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/machine_tracker.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>

namespace surefoot::odometry {
namespace {

const Pose kT_body_camera{exp_so3({-1.2, 0.1, -1.5}), {0.1, 0.2, 0.05}};
const Pose kT_odom_camera{exp_so3({0.3, -0.2, 0.5}), {1.0, 2.0, 3.0}};

MachineMotion motion() {
    MachineMotion known{{exp_so3({0.01, 0.02, -0.01}), {0.02, -0.01, 0.005}}, Matrix6::Zero()};
    known.covariance.diagonal() << 1e-6, 2e-6, 3e-6, 4e-6, 5e-6, 6e-6;
    known.covariance(0, 4) = known.covariance(4, 0) = 1e-6;
    return known;
}

TEST(MachineTracker, CarriesTheCameraWithItsCovariance) {
    MachineTracker machine(kT_body_camera);
    machine.advance(motion());
    EXPECT_FALSE(machine.reckoned());  // not placed
    machine.place(kT_odom_camera);
    machine.advance(motion());
    machine.advance(motion());
    const auto known = machine.reckoned();
    ASSERT_TRUE(known);
    const Pose T_body = kT_odom_camera * kT_body_camera.inverse();
    const Pose T_body_then = T_body * motion().T_previous_body * motion().T_previous_body;
    EXPECT_LT(difference(T_body_then * kT_body_camera, known->T_odom_camera).norm(), 1e-12);
    const Matrix6 twice =
        compose_covariance(motion().covariance, motion().T_previous_body, motion().covariance);
    EXPECT_LT((camera_to_body_covariance(known->covariance, kT_body_camera) - twice).norm(), 1e-15);
}

TEST(MachineTracker, WeighsByCovariance) {
    MachineTracker machine(kT_body_camera);
    machine.place(kT_odom_camera);
    machine.advance(motion());
    const CameraFix known = *machine.reckoned();
    Vector6 off;
    off << 1e-4, -1e-4, 2e-4, 1e-4, 2e-4, -1e-4;
    CameraFix seen{perturbed(known.T_odom_camera, -off), Matrix6::Zero()};
    seen.covariance.diagonal() << 4e-6, 1e-6, 2e-6, 1e-6, 8e-6, 2e-6;
    const CameraFix both = machine.improved(seen);
    const Matrix6 information = seen.covariance.inverse() + known.covariance.inverse();
    EXPECT_LT((both.covariance.inverse() - information).norm(), 1e-6 * information.norm());
    const Vector6 expected = information.inverse() * known.covariance.inverse() * off;
    EXPECT_LT((difference(seen.T_odom_camera, both.T_odom_camera) - expected).norm(), 1e-7);
}

TEST(MachineTracker, ContradictionsAreLeftOutAndCounted) {
    MachineTracker machine(kT_body_camera);
    CameraFix seen{kT_odom_camera, 1e-8 * Matrix6::Identity()};
    for (int i = 0; i < 3; ++i) {
        EXPECT_FALSE(machine.disagrees());
        machine.place(kT_odom_camera);
        machine.advance(motion());
        EXPECT_EQ(difference(seen.T_odom_camera, machine.improved(seen).T_odom_camera).norm(), 0.0);
    }
    EXPECT_TRUE(machine.disagrees());
    machine.place(kT_odom_camera);
    machine.advance(motion());
    static_cast<void>(machine.improved({machine.reckoned()->T_odom_camera, seen.covariance}));
    EXPECT_FALSE(machine.disagrees());
}

TEST(MachineTracker, AMotionThatIsMissingOrNoneEndsIt) {
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), -1.0}) {
        MachineTracker machine(kT_body_camera);
        machine.place(kT_odom_camera);
        MachineMotion known = motion();
        known.covariance(1, 1) = bad;
        machine.advance(known);
        EXPECT_FALSE(machine.reckoned());
        machine.advance(motion());
        EXPECT_FALSE(machine.reckoned());  // until the next place
        machine.place(kT_odom_camera);
        machine.advance(motion());
        EXPECT_TRUE(machine.reckoned());
        machine.advance(std::nullopt);
        EXPECT_FALSE(machine.reckoned());
    }
}

}  // namespace
}  // namespace surefoot::odometry
