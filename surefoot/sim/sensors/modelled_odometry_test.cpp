// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/modelled_odometry.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace surefoot::sim {
namespace {

/// Ahead by 1 cm a frame, in a curve.
Pose way(int frame) {
    Pose T_world_body;
    T_world_body.rotation = exp_so3({0.0, 0.0, 0.001 * frame});
    T_world_body.translation_m = {3.0 + 0.01 * frame, -1.0, 0.95};
    return T_world_body;
}

TEST(ModelledOdometryTest, WithoutDriftItIsTheTruthFromTheFirstBody) {
    ModelledOdometry odometry({0.0, 0.0}, T_body_optical(), 1);
    for (int frame = 0; frame < 50; ++frame) {
        const MotionEstimate motion = odometry.follow(7 + frame, frame, way(frame));
        EXPECT_EQ(motion.time_ns, 7 + frame);
        EXPECT_EQ(motion.health, Health::ok);
        EXPECT_EQ(motion.relative_covariance, Matrix6::Zero());
        const Pose truth = way(0).inverse() * way(frame);
        EXPECT_LT(difference(truth, motion.T_odom_body).norm(), 1e-12) << frame;
    }
}

TEST(ModelledOdometryTest, ErrorsAreAsLargeAsReportedAndGrowWithTheRootOfTheWay) {
    const DriftConfig config{0.002, 0.1};
    constexpr int kFrames = 5000;
    ModelledOdometry odometry(config, Pose{}, 5);
    (void)odometry.follow(0, 0, way(0));
    double squares = 0.0;
    Vector6 variance = Vector6::Zero();
    for (int frame = 1; frame <= kFrames; ++frame) {
        const MotionEstimate motion = odometry.follow(frame, frame, way(frame));
        const Vector6 error =
            difference(way(frame - 1).inverse() * way(frame), motion.T_previous_body);
        squares +=
            error.dot(motion.relative_covariance.diagonal().cwiseInverse().cwiseProduct(error));
        if (frame <= 100) variance += motion.relative_covariance.diagonal();
    }
    // The mean of chi squares of 6 has a standard error of sqrt(12 / n); five of them.
    EXPECT_NEAR(squares / kFrames, 6.0, 5.0 * std::sqrt(12.0 / kFrames));
    // 100 frames are one metre.
    EXPECT_NEAR(std::sqrt(variance[0]), 0.002, 1e-9);
    EXPECT_NEAR(std::sqrt(variance[5]), 0.1 * 3.14159265358979 / 180.0, 1e-9);
}

TEST(ModelledOdometryTest, StandingStillIsHeldExactlyAndTurningIsAWay) {
    Pose T_body_camera;
    T_body_camera.translation_m = {0.3, 0.0, 0.0};
    ModelledOdometry odometry({}, T_body_camera, 5);
    (void)odometry.follow(0, 0, way(0));
    const MotionEstimate still = odometry.follow(1, 1, way(0));
    EXPECT_LT(difference(Pose{}, still.T_odom_body).norm(), 1e-12);
    EXPECT_LT(still.relative_covariance.norm(), 1e-20);
    Pose turned = way(0);
    turned.rotation = exp_so3({0.0, 0.0, 0.1});
    EXPECT_GT(odometry.follow(2, 2, turned).relative_covariance(0, 0), 0.02 * 1e-6);
}

}  // namespace
}  // namespace surefoot::sim
