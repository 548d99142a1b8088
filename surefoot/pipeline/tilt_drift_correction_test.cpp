// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/tilt_drift_correction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::pipeline {
namespace {

constexpr double kPeriod_s = 0.1;
constexpr double kRounding_deg_s = 1e-9;

/// A machine that sways while it walks ahead, an odometry with growing tilt, and a plane measured
/// with noise.
struct World {
    double drift_deg_s = 0.0;  ///< drift of the odometry, about x
    double start_deg = 0.0;    ///< initial tilt of odom
    double slope_deg = 0.0;    ///< slope of the ground, about x
    double noise_deg = 0.2;    ///< noise of a plane
    double lost_share = 0.0;   ///< share of lost frames
    double wall_share = 0.0;   ///< share of steep planes

    [[nodiscard]] static Pose true_body(double time_s) {
        return {exp_so3({0.08 * std::sin(time_s), 0.05 * std::sin(0.7 * time_s), 0.01 * time_s}),
                {0.05 * time_s, 0.0, 1.0}};
    }
};

struct Walked {
    double tilt_deg = 0.0;       ///< tilt of odom at the end
    double fastest_deg_s = 0.0;  ///< turn in addition to the odometry's own
    double displaced_m = 0.0;    ///< largest position error against the chained motions
};

Walked walk(const World& world, double seconds, const LevelConfig& config = {}) {
    Rng rng(5);
    TiltDriftCorrection keeper(config);
    const Eigen::Quaterniond R_odom_world = exp_so3({-world.start_deg * kRadPerDeg, 0.0, 0.0});
    Pose T_found = {R_odom_world * World::true_body(0.0).rotation,
                    World::true_body(0.0).translation_m};
    keeper.start_at(T_found);
    Pose T_drifted = T_found;
    Pose T_true = World::true_body(0.0);
    Walked walked;
    for (int i = 1; i * kPeriod_s <= seconds; ++i) {
        const Pose T_now = World::true_body(i * kPeriod_s);
        MotionEstimate motion;
        motion.time_ns = 1'000'000'000 + static_cast<std::int64_t>(1e9 * kPeriod_s * i);
        motion.health = rng.uniform() < world.lost_share ? Health::lost : Health::ok;
        motion.T_previous_body = T_true.inverse() * T_now;
        motion.T_previous_body.rotation =
            motion.T_previous_body.rotation *
            exp_so3(T_now.rotation.conjugate() *
                    Eigen::Vector3d(world.drift_deg_s * kRadPerDeg * kPeriod_s, 0.0, 0.0));
        T_true = T_now;
        T_drifted = T_drifted * motion.T_previous_body;
        motion.T_odom_body = T_drifted;
        const MotionEstimate leveled = keeper.level(motion);
        const Pose T_expected = T_found * motion.T_previous_body;
        const Vector6 turned = difference(T_expected, leveled.T_odom_body);
        walked.fastest_deg_s =
            std::max(walked.fastest_deg_s, turned.tail<3>().norm() / kRadPerDeg / kPeriod_s);
        walked.displaced_m = std::max(walked.displaced_m, turned.head<3>().norm());
        EXPECT_LT(difference(T_found * leveled.T_previous_body, leveled.T_odom_body).norm(), 1e-12);
        T_found = leveled.T_odom_body;

        const bool wall = rng.uniform() < world.wall_share;
        const double x = rng.normal();
        const Eigen::Vector3d lean(world.slope_deg + (wall ? 60.0 : 0.0) + world.noise_deg * x,
                                   world.noise_deg * rng.normal(),
                                   0.0);
        GroundObservation plane;
        plane.accepted = true;
        plane.normal =
            T_now.rotation.conjugate() * (exp_so3(kRadPerDeg * lean) * Eigen::Vector3d::UnitZ());
        keeper.see(plane);
    }
    const Eigen::Vector3d up =
        T_found.rotation * (T_true.rotation.conjugate() * Eigen::Vector3d::UnitZ());
    walked.tilt_deg = std::atan2(up.head<2>().norm(), up.z()) / kRadPerDeg;
    return walked;
}

LevelConfig switched_off() {
    LevelConfig config;
    config.enabled = false;
    return config;
}

TEST(TiltDriftCorrection, AnHourOfDriftStaysSmall) {
    World world;
    world.drift_deg_s = 0.001;
    EXPECT_NEAR(walk(world, 3600.0, switched_off()).tilt_deg, 3.6, 0.1);
    const Walked walked = walk(world, 3600.0);
    EXPECT_LT(walked.tilt_deg, 0.4);
    EXPECT_LE(walked.fastest_deg_s, 0.005 + 1e-9);
    EXPECT_LT(walked.displaced_m, 1e-12);
}

TEST(TiltDriftCorrection, WhatAPlaneMayErrChangesNothing) {
    World world;
    world.start_deg = 0.2;
    EXPECT_LT(walk(world, 300.0).fastest_deg_s, kRounding_deg_s);
}

TEST(TiltDriftCorrection, ItStopsWhereAPlaneTellsNoMore) {
    World world;
    world.start_deg = 0.6;
    LevelConfig slow_mean;
    slow_mean.average_s = 120.0;
    EXPECT_NEAR(walk(world, 600.0, slow_mean).tilt_deg, slow_mean.ignored_deg, 0.03);
}

TEST(TiltDriftCorrection, ASlopeIsNoDrift) {
    World world;
    world.slope_deg = 4.8;  // 1:12
    const Walked walked = walk(world, 300.0);
    EXPECT_LT(walked.fastest_deg_s, kRounding_deg_s);
    EXPECT_LT(walked.tilt_deg, 0.01);
}

TEST(TiltDriftCorrection, WhereSlopesAndFloorsTakeTurnsNothingIsSaid) {
    World world;
    world.start_deg = 0.6;
    world.wall_share = 0.5;
    EXPECT_LT(walk(world, 300.0).fastest_deg_s, kRounding_deg_s);
    world.wall_share = 0.02;
    EXPECT_LT(walk(world, 300.0).tilt_deg, 0.4);
}

TEST(TiltDriftCorrection, LostPosesSeeNoGround) {
    World world;
    world.start_deg = 0.6;
    world.lost_share = 1.0;
    EXPECT_LT(walk(world, 300.0).fastest_deg_s, kRounding_deg_s);
}

}  // namespace
}  // namespace surefoot::pipeline
