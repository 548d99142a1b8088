// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/mount_monitor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "surefoot/core/angles.hpp"

namespace surefoot::pipeline {
namespace {

constexpr double kPeriod_s = 0.1;

Eigen::Quaterniond leaning(double roll_deg, double pitch_deg) {
    return Eigen::AngleAxisd(pitch_deg * kRadPerDeg, Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(roll_deg * kRadPerDeg, Eigen::Vector3d::UnitX());
}

/// Tilt of the machine against gravity, of the camera on the machine, and of the ground, at a time;
/// each as a rotation.
struct World {
    std::function<Eigen::Quaterniond(double)> machine;
    std::function<Eigen::Quaterniond(double)> knock;
    std::function<Eigen::Quaterniond(double)> ground;
};

Eigen::Quaterniond upright(double /*time_s*/) {
    return Eigen::Quaterniond::Identity();
}

/// One step in ten seconds, as the simulated REX makes it: it sways to both sides for 8.5 s and
/// stands upright for the rest, while its frame still vibrates a little. It is never exactly at
/// rest.
Eigen::Quaterniond gait(double time_s, double sway_deg) {
    const double phase_s = std::fmod(time_s, 10.0);
    const double ringing_deg = 0.1 * std::sin(20.0 * time_s);
    if (phase_s >= 8.5) return leaning(ringing_deg, ringing_deg);
    const double swing = std::sin(phase_s * 2.0 * M_PI / 8.5);
    return leaning(sway_deg * std::clamp(1.2 * swing, -1.0, 1.0) + ringing_deg, ringing_deg);
}

/// Returns the time at which the monitor reports a moved mount, or nothing within a minute.
std::optional<double> said_at_s(const World& world, const AlignmentConfig& config = {}) {
    MountMonitor monitor(config);
    Eigen::Quaterniond before = world.machine(0.0) * world.knock(0.0);
    for (int i = 0; i <= 600; ++i) {
        const double time_s = i * kPeriod_s;
        MotionEstimate motion;
        motion.time_ns = static_cast<std::int64_t>(1e9 * time_s);
        motion.health = Health::ok;
        motion.T_odom_body.rotation = world.machine(time_s) * world.knock(time_s);
        motion.T_previous_body.rotation = before.conjugate() * motion.T_odom_body.rotation;
        before = motion.T_odom_body.rotation;
        GroundObservation plane;
        plane.accepted = true;
        plane.normal = before.conjugate() * (world.ground(time_s) * Eigen::Vector3d::UnitZ());
        monitor.add(motion, plane);
        if (monitor.moved()) return time_s;
    }
    return std::nullopt;
}

std::function<Eigen::Quaterniond(double)> from(double start_s, const Eigen::Quaterniond& lean) {
    return [=](double time_s) { return time_s < start_s ? upright(0.0) : lean; };
}

TEST(MountMonitor, AWalkingMachineSwaysAndComesHome) {
    for (const double sway_deg : {2.0, 4.0, 5.4}) {
        const auto walk = [=](double time_s) { return gait(time_s, sway_deg); };
        EXPECT_FALSE(said_at_s({walk, upright, upright})) << sway_deg;
    }
}

TEST(MountMonitor, AKnockIsSaidWithinFourSecondsOfRestOrTwoSteps) {
    const auto walk = [](double time_s) { return gait(time_s, 3.0); };
    for (const auto& knock :
         {leaning(1.5, 0.0), leaning(-1.5, 0.0), leaning(0.0, 1.5), leaning(3.0, -4.0)}) {
        const auto standing = said_at_s({upright, from(10.0, knock), upright});
        ASSERT_TRUE(standing);
        EXPECT_LE(*standing, 14.3);
        const auto walking = said_at_s({walk, from(12.0, knock), upright});
        ASSERT_TRUE(walking);
        EXPECT_LE(*walking, 32.0);
    }
    const auto hard = said_at_s({walk, from(12.0, leaning(0.0, 10.0)), upright});
    ASSERT_TRUE(hard);
    EXPECT_LE(*hard, 12.7) << "farther than any gait";
}

/// Leaning within a minute: its first time, and its total duration.
struct Leaning {
    std::optional<double> first_s;
    double lasts_s = 0.0;
};

Leaning leaning_of(const World& world) {
    MountMonitor monitor({});
    Leaning told;
    for (int i = 0; i <= 600; ++i) {
        const double time_s = i * kPeriod_s;
        MotionEstimate motion;
        motion.time_ns = static_cast<std::int64_t>(1e9 * time_s);
        motion.health = Health::ok;
        motion.T_odom_body.rotation = world.machine(time_s) * world.knock(time_s);
        GroundObservation plane;
        plane.accepted = true;
        // Error of the plane of one frame, to alternating sides.
        const Eigen::Quaterniond wrong = leaning(i % 2 == 0 ? 0.3 : -0.3, i % 3 == 0 ? 0.3 : -0.3);
        plane.normal = motion.T_odom_body.rotation.conjugate() *
                       (world.ground(time_s) * wrong * Eigen::Vector3d::UnitZ());
        if (i == 0) plane.normal = Eigen::Vector3d::UnitZ();
        monitor.add(motion, plane);
        if (!monitor.leans()) continue;
        if (!told.first_s) told.first_s = time_s;
        told.lasts_s += kPeriod_s;
    }
    return told;
}

TEST(MountMonitor, NoStepBeginsFromTheFirstFrameThatShowsAKnock) {
    for (const auto& knock :
         {leaning(1.0, 0.0), leaning(-1.0, 0.0), leaning(0.0, 1.5), leaning(3.0, -4.0)}) {
        const Leaning told = leaning_of({upright, from(10.0, knock), upright});
        ASSERT_TRUE(told.first_s);
        EXPECT_NEAR(*told.first_s, 10.0, 1e-9);
        EXPECT_NEAR(told.lasts_s, 50.1, 0.15) << "and not from any other";
    }
}

TEST(MountMonitor, AWalkingMachineLeansInItsStepsAndStandsBetweenThem) {
    const Leaning walk = leaning_of({[](double t) { return gait(t, 3.0); }, upright, upright});
    ASSERT_TRUE(walk.first_s);
    EXPECT_LT(*walk.first_s, 1.0);
    EXPECT_GT(walk.lasts_s, 30.0);
    const Leaning stand =
        leaning_of({[](double t) { return gait(8.5 + std::fmod(t, 1.5), 3.0); }, upright, upright});
    EXPECT_FALSE(stand.first_s);
}

TEST(MountMonitor, SlopesAndDriftDoNotKeepStepsFromBeginning) {
    const Eigen::Quaterniond ramp = leaning(0.0, -4.8);
    EXPECT_FALSE(leaning_of({upright, upright, from(10.0, ramp)}).first_s) << "upright on a ramp";
    EXPECT_FALSE(leaning_of({from(10.0, ramp), upright, from(10.0, ramp)}).first_s)
        << "square to it";
    const Eigen::Quaterniond drift = leaning(1.5, 1.0);
    EXPECT_FALSE(leaning_of({from(10.0, drift), upright, from(10.0, drift)}).first_s);
}

TEST(MountMonitor, SlopesAndDriftLeanAloneAndAreNoKnock) {
    const Eigen::Quaterniond ramp = leaning(0.0, -4.8);
    EXPECT_FALSE(said_at_s({upright, upright, from(10.0, ramp)})) << "upright on a ramp";
    EXPECT_FALSE(said_at_s({from(10.0, ramp), upright, from(10.0, ramp)})) << "square to it";
    EXPECT_FALSE(said_at_s({from(10.0, leaning(2.0, 0.0)), upright, from(10.0, ramp)}))
        << "both lean, but not by the same turn";
    // The odometry tilts, and the ground seems to tilt with it.
    const Eigen::Quaterniond drift = leaning(1.5, 1.0);
    EXPECT_FALSE(said_at_s({from(10.0, drift), upright, from(10.0, drift)}));
}

TEST(MountMonitor, WhatWasNotSeenIsNotJudged) {
    MountMonitor monitor(AlignmentConfig{});
    GroundObservation level;
    level.accepted = true;
    MotionEstimate first;
    first.health = Health::ok;
    monitor.add(first, level);
    EXPECT_FALSE(monitor.leans());
    GroundObservation knocked = level;
    knocked.normal = leaning(0.0, 5.0).conjugate() * Eigen::Vector3d::UnitZ();
    for (int i = 0; i < 300; ++i) {
        MotionEstimate motion;
        motion.time_ns = i * 100'000'000LL;
        motion.T_odom_body.rotation = leaning(0.0, 5.0);
        motion.health = i % 2 == 0 ? Health::lost : Health::ok;
        knocked.accepted = motion.health == Health::lost;
        monitor.add(motion, knocked);
    }
    EXPECT_FALSE(monitor.moved());
    EXPECT_EQ(monitor.lean_rad(), 0.0);
}

TEST(MountMonitor, StaysMovedUntilStartedAnew) {
    MountMonitor monitor(AlignmentConfig{});
    GroundObservation level;
    level.accepted = true;
    MotionEstimate first;
    first.health = Health::ok;
    monitor.add(first, level);
    GroundObservation knocked = level;
    knocked.normal = leaning(0.0, 3.0).conjugate() * Eigen::Vector3d::UnitZ();
    MotionEstimate motion;
    motion.health = Health::ok;
    for (int i = 0; i < 60; ++i) {
        const bool back = i > 50;
        motion.time_ns = i * 100'000'000LL;
        motion.T_odom_body.rotation = back ? leaning(0.0, 0.0) : leaning(0.0, 3.0);
        monitor.add(motion, back ? level : knocked);
    }
    EXPECT_TRUE(monitor.moved());
}

}  // namespace
}  // namespace surefoot::pipeline
