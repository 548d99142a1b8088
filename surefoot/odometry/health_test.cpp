// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/health.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace surefoot::odometry {
namespace {

HealthEvidence good() {
    HealthEvidence e;
    e.pose_found = true;
    e.tracks = 200;
    e.inliers = 180;
    e.depth_inliers = 170;
    e.residual_px = 0.3;
    e.gap_s = 0.05;
    e.translation_sigma_m = 0.0005;
    e.rotation_sigma_rad = 0.0003;
    e.scene_depth_m = 2.0;
    return e;
}

void expect(const HealthEvidence& evidence, Health health, HealthReason reason) {
    const HealthVerdict verdict = judge({}, evidence);
    EXPECT_STREQ(to_string(verdict.health), to_string(health));
    EXPECT_STREQ(to_string(verdict.reason), to_string(reason));
}

TEST(Health, DefaultEvidenceIsLost) {
    expect({}, Health::lost, HealthReason::few_tracks);
}

TEST(Health, EveryReasonHasItsCause) {
    HealthEvidence e = good();
    expect(e, Health::ok, HealthReason::none);
    e = good();
    e.inliers = 9;
    expect(e, Health::lost, HealthReason::few_tracks);
    e = good();
    e.inliers = 29;
    expect(e, Health::degraded, HealthReason::few_tracks);
    e = good();
    e.inliers = 60;  // 30 % of the tracks
    expect(e, Health::degraded, HealthReason::few_tracks);
    e = good();
    e.translation_sigma_m = 0.03;
    expect(e, Health::degraded, HealthReason::poor_geometry);
    e.translation_sigma_m = 0.3;
    expect(e, Health::lost, HealthReason::poor_geometry);
    e = good();
    e.residual_px = 2.0;
    expect(e, Health::degraded, HealthReason::large_residual);
    e = good();
    e.gap_s = 1.5;
    expect(e, Health::degraded, HealthReason::time_gap);
    e = good();
    e.imu_disagrees = true;
    expect(e, Health::degraded, HealthReason::imu_disagreement);
    e.imu_disagrees = false;
    e.machine_disagrees = true;
    expect(e, Health::degraded, HealthReason::machine_disagreement);
    e.residual_px = 2.0;  // the reason of vision comes first
    expect(e, Health::degraded, HealthReason::large_residual);
    e = good();
    e.beyond_machine = true;
    expect(e, Health::lost, HealthReason::beyond_machine);
    e = good();
    e.cameras_swapped = true;
    expect(e, Health::lost, HealthReason::cameras_swapped);
    e = good();
    e.sharpness_ratio = 0.2;
    expect(e, Health::degraded, HealthReason::blur);
    e.pose_found = false;
    expect(e, Health::lost, HealthReason::blur);
    e.gap_s = 3.0;
    expect(e, Health::lost, HealthReason::time_gap);
}

TEST(Health, ASecondMotionIsAMovingScene) {
    HealthEvidence e = good();
    e.other_motion = 14;  // mismatches may agree by chance
    expect(e, Health::ok, HealthReason::none);
    e.inliers = 100;
    e.other_motion = 15;
    expect(e, Health::ok, HealthReason::none);
    e.other_motion = 20;
    expect(e, Health::degraded, HealthReason::moving_scene);
    e.inliers = 60;  // the inliers are a minority of the tracks, because of the second motion
    expect(e, Health::degraded, HealthReason::moving_scene);
}

TEST(Health, TheFirstPoseAfterALossIsSaid) {
    HealthEvidence e = good();
    e.was_unsure = true;
    expect(e, Health::degraded, HealthReason::recovered);
}

TEST(Health, AGapOfTheImuIsSaidAndIsNoHarm) {
    HealthEvidence e = good();
    e.imu_gap = true;
    expect(e, Health::ok, HealthReason::imu_gap);
    e.imu_disagrees = true;
    expect(e, Health::degraded, HealthReason::imu_disagreement);
    e.inliers = 9;
    expect(e, Health::lost, HealthReason::few_tracks);
}

TEST(Health, GapsAreThoseLongerThanUsualAndStampsThatDoNotGrow) {
    HealthEvidence e = good();
    e.usual_gap_s = 0.1;
    e.gap_s = 0.3;  // two frames dropped
    expect(e, Health::ok, HealthReason::none);
    e.gap_s = 0.4;
    expect(e, Health::degraded, HealthReason::time_gap);
    e.usual_gap_s = 0.0;  // unknown
    expect(e, Health::ok, HealthReason::none);
    e.stamp_grows = false;
    expect(e, Health::degraded, HealthReason::time_gap);
}

TEST(Health, WithoutDepthOfItsOwnAFrameIsDegradedAndLostWhereTheEyesShowDifferentThings) {
    HealthEvidence e = good();
    e.depth_inliers = 9;
    e.right_shows_something = true;
    expect(e, Health::degraded, HealthReason::poor_geometry);
    e.depth_inliers = 0;
    expect(e, Health::lost, HealthReason::poor_geometry);
    e.right_shows_something = false;
    expect(e, Health::degraded, HealthReason::poor_geometry);
}

TEST(Health, NotANumberIsLost) {
    HealthEvidence e = good();
    e.translation_sigma_m = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(judge({}, e).health, Health::lost);
    e = good();
    e.scene_depth_m = 0.0;
    EXPECT_EQ(judge({}, e).health, Health::lost);
}

TEST(Health, LostCovarianceAddsUpToSpeedTimesTime) {
    const OdometryConfig config;
    Matrix6 sum = Matrix6::Zero();
    for (int i = 0; i < 10; ++i) sum += lost_covariance(config, 0.1 * i, 0.1 * (i + 1));
    EXPECT_NEAR(sum(0, 0), config.lost_speed_m_s * config.lost_speed_m_s, 1e-12);
    EXPECT_NEAR(sum(5, 5), config.lost_turn_rad_s * config.lost_turn_rad_s, 1e-12);
}

}  // namespace
}  // namespace surefoot::odometry
