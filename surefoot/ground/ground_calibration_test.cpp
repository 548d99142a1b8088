// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/ground_calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::ground {
namespace {

constexpr double kRounding = 1e-12;

/// Observation of a body that is tilted by `roll_deg` and `pitch_deg`, at a height.
GroundSighting sighting(double roll_deg, double pitch_deg, double height_m, bool accepted = true) {
    const Eigen::Quaterniond R_world_body =
        exp_so3({0.0, pitch_deg * kRadPerDeg, 0.0}) * exp_so3({roll_deg * kRadPerDeg, 0.0, 0.0});
    GroundSighting sighting;
    GroundObservation& observation = sighting.observation;
    observation.accepted = accepted;
    observation.normal = R_world_body.conjugate() * Eigen::Vector3d::UnitZ();
    observation.height_m = height_m;
    return sighting;
}

TEST(TiltRotation, TakesTheNormalToZWithoutYaw) {
    Rng rng(1);
    for (int trial = 0; trial < 200; ++trial) {
        const Eigen::Vector3d normal =
            Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized();
        const Eigen::Quaterniond q = tilt_rotation(normal);
        EXPECT_LE((q * normal - Eigen::Vector3d::UnitZ()).norm(), 1e-9) << normal.transpose();
        EXPECT_NEAR(q.z(), 0.0, kRounding) << "the axis is horizontal";
        EXPECT_NEAR(2.0 * std::acos(q.w()), std::acos(normal.z()), 1e-6) << "eq. 4.1";
    }
    EXPECT_EQ(tilt_rotation(Eigen::Vector3d::UnitZ()).w(), 1.0);
    EXPECT_LE((tilt_rotation(-Eigen::Vector3d::UnitZ()) * -Eigen::Vector3d::UnitZ() -
               Eigen::Vector3d::UnitZ())
                  .norm(),
              kRounding);
}

TEST(GroundCalibration, NothingSeenIsNotAccepted) {
    GroundCalibration calibration{GroundConfig{}};
    EXPECT_EQ(calibration.alignment().reason, CalibrationReason::no_observation);
    for (int i = 0; i < 20; ++i) calibration.add(sighting(0.0, 0.0, 1.0, false));
    EXPECT_EQ(calibration.alignment().reason, CalibrationReason::no_observation);
    EXPECT_FALSE(calibration.alignment().accepted);
}

TEST(GroundCalibration, SingleShotIsNotEnough) {
    GroundCalibration calibration{GroundConfig{}};
    for (int i = 0; i < GroundConfig{}.min_agreeing; ++i) {
        EXPECT_FALSE(calibration.alignment().accepted) << i;
        calibration.add(sighting(1.0, 2.0, 1.0));
    }
    EXPECT_TRUE(calibration.alignment().accepted);
}

TEST(GroundCalibration, PoseTakesGroundPointsToZeroHeight) {
    GroundCalibration calibration{GroundConfig{}};
    const GroundSighting seen = sighting(4.0, -7.0, 0.95);
    for (int i = 0; i < 10; ++i) calibration.add(seen);
    const GroundAlignment alignment = calibration.alignment();
    ASSERT_TRUE(alignment.accepted);
    EXPECT_NEAR(alignment.height_m, 0.95, kRounding);
    EXPECT_NEAR(alignment.tilt_rad, std::acos(seen.observation.normal.z()), 1e-9);
    const Eigen::Vector3d foot_body = -seen.observation.height_m * seen.observation.normal;
    EXPECT_LE((alignment.T_ground_body * foot_body).norm(), 1e-9);
    const Eigen::Vector3d on_plane_body =
        foot_body + seen.observation.normal.cross(Eigen::Vector3d(1, 2, 3));
    EXPECT_NEAR((alignment.T_ground_body * on_plane_body).z(), 0.0, 1e-9);
    EXPECT_NEAR((alignment.T_ground_body * Eigen::Vector3d::Zero()).z(), 0.95, 1e-9);
}

TEST(GroundCalibration, NoiseAveragesOut) {
    constexpr double kTilt_deg = 0.2;
    constexpr double kHeight_m = 0.005;
    GroundConfig config;
    config.window = 100;
    GroundCalibration calibration(config);
    Rng rng(2);
    for (int i = 0; i < 100; ++i) {
        calibration.add(sighting(3.0 + kTilt_deg * rng.normal(),
                                 -2.0 + kTilt_deg * rng.normal(),
                                 1.04 + kHeight_m * rng.normal()));
    }
    const GroundAlignment alignment = calibration.alignment();
    ASSERT_TRUE(alignment.accepted);
    const Eigen::Vector3d truth = sighting(3.0, -2.0, 1.04).observation.normal;
    const double sigmas = 4.0 / std::sqrt(100.0);
    EXPECT_LE(std::acos(std::min(1.0, alignment.normal_body.dot(truth))),
              sigmas * std::sqrt(2.0) * kTilt_deg * kRadPerDeg);
    EXPECT_NEAR(alignment.height_m, 1.04, sigmas * kHeight_m);
}

TEST(GroundCalibration, DisagreeingSingleShotsAreLeftOut) {
    GroundCalibration calibration{GroundConfig{}};
    calibration.add(sighting(0.0, 8.0, 1.0));  // distorted by over-exposure
    for (int i = 0; i < 7; ++i) calibration.add(sighting(0.0, 1.0, 1.0));
    calibration.add(sighting(0.0, 1.0, 0.3));  // a table top
    const GroundAlignment alignment = calibration.alignment();
    ASSERT_TRUE(alignment.accepted);
    EXPECT_EQ(alignment.agreeing, 7);
    EXPECT_EQ(alignment.rejected, 2);
    EXPECT_NEAR(alignment.tilt_rad, 1.0 * kRadPerDeg, 1e-9);
    EXPECT_NEAR(alignment.height_m, 1.0, kRounding);
}

TEST(GroundCalibration, WithoutAMajorityNothingIsAccepted) {
    GroundCalibration calibration{GroundConfig{}};
    for (int i = 0; i < 5; ++i) {
        calibration.add(sighting(0.0, 0.0, 1.0));
        calibration.add(sighting(0.0, 5.0, 1.0));
    }
    const GroundAlignment alignment = calibration.alignment();
    EXPECT_FALSE(alignment.accepted);
    EXPECT_EQ(alignment.reason, CalibrationReason::disagreement);
}

TEST(GroundCalibration, WindowForgetsABadStart) {
    GroundCalibration calibration{GroundConfig{}};
    for (int i = 0; i < 30; ++i) calibration.add(sighting(0.0, i, 1.0));  // exposure still adapting
    EXPECT_FALSE(calibration.alignment().accepted);
    for (int i = 0; i < 10; ++i) calibration.add(sighting(0.0, 2.0, 1.0));
    const GroundAlignment alignment = calibration.alignment();
    EXPECT_TRUE(alignment.accepted);
    EXPECT_NEAR(alignment.tilt_rad, 2.0 * kRadPerDeg, 1e-9);
    calibration.clear();
    EXPECT_EQ(calibration.alignment().reason, CalibrationReason::no_observation);
}

TEST(GroundCalibration, SightingsThatAreNotFiniteAreIgnored) {
    GroundCalibration calibration{GroundConfig{}};
    GroundSighting bad = sighting(0.0, 0.0, std::numeric_limits<double>::quiet_NaN());
    calibration.add(bad);
    bad = sighting(0.0, 0.0, 1.0);
    bad.observation.normal.x() = std::numeric_limits<double>::quiet_NaN();
    calibration.add(bad);
    EXPECT_EQ(calibration.alignment().reason, CalibrationReason::no_observation);
}

}  // namespace
}  // namespace surefoot::ground
