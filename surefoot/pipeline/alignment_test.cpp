// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace surefoot::pipeline {
namespace {

constexpr double kRounding = 1e-9;
constexpr double kRadPerDeg = M_PI / 180.0;

/// Up in a base_link that is pitched down and rolled.
Eigen::Vector3d up_in_body(double pitch_down_rad, double roll_rad) {
    const Eigen::Quaterniond R_odom_body =
        Eigen::Quaterniond(Eigen::AngleAxisd(pitch_down_rad, Eigen::Vector3d::UnitY()) *
                           Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX()));
    return R_odom_body.conjugate() * Eigen::Vector3d::UnitZ();
}

ground::GroundAlignment plane(const Eigen::Vector3d& normal, double height_m) {
    ground::GroundAlignment ground;
    ground.accepted = true;
    ground.reason = ground::CalibrationReason::accepted;
    ground.normal_body = normal;
    ground.height_m = height_m;
    return ground;
}

std::vector<StereoFrame> resting_imu(const Eigen::Vector3d& force, const Eigen::Vector3d& gyro) {
    StereoFrame frame;
    for (int i = 0; i < 20; ++i) frame.imu.push_back({i * 5'000'000, gyro, force});
    return {frame};
}

TEST(Alignment, puts_odom_on_the_plane_under_base_link_with_its_heading) {
    const Eigen::Vector3d up = up_in_body(32 * kRadPerDeg, 4 * kRadPerDeg);
    const Alignment a = place_odom({}, plane(up, 1.2), std::nullopt);
    EXPECT_EQ(a.gravity_source, grid::GravitySource::plane);
    EXPECT_LT((a.T_odom_body.rotation * up - Eigen::Vector3d::UnitZ()).norm(), kRounding);
    EXPECT_NEAR(yaw_rad(a.T_odom_body), 0.0, kRounding);
    EXPECT_LT((a.T_odom_body.translation_m - Eigen::Vector3d(0, 0, 1.2)).norm(), kRounding);
}

TEST(Alignment, takes_gravity_from_the_accelerometer_on_a_ramp_and_the_height_along_it) {
    const Eigen::Vector3d up_imu = Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d normal = up_in_body(5 * kRadPerDeg, 0.0);  // a ramp of 5 deg
    const Alignment a = place_odom({}, plane(normal, 1.0), up_imu);
    EXPECT_EQ(a.gravity_source, grid::GravitySource::imu);
    EXPECT_LT((a.T_odom_body.rotation * up_imu - Eigen::Vector3d::UnitZ()).norm(), kRounding);
    EXPECT_NEAR(a.ground_height_m, 1.0 / std::cos(5 * kRadPerDeg), kRounding);
}

TEST(Alignment, a_ground_where_the_machine_cannot_stand_is_a_wrong_scale) {
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    for (const auto& up_imu : {std::optional<Eigen::Vector3d>(), std::optional(up)}) {
        for (const double height_m : {2.0, 0.5}) {  // twice or half the baseline
            const Alignment a = place_odom({}, plane(up, height_m), up_imu, 1.0);
            EXPECT_EQ(a.gravity_source, grid::GravitySource::assumed);
            EXPECT_NE(a.reason.find("baseline"), std::string::npos);
        }
        const Alignment kerb = place_odom({}, plane(up, 1.2), up_imu, 1.0);
        EXPECT_EQ(kerb.gravity_source, grid::GravitySource::plane);
    }
}

TEST(Alignment, without_a_plane_stays_at_base_link_and_says_what_it_used) {
    const Alignment by_imu = place_odom({}, {}, up_in_body(0.3, 0.1));
    EXPECT_EQ(by_imu.gravity_source, grid::GravitySource::imu);
    EXPECT_EQ(by_imu.T_odom_body.translation_m.norm(), 0.0);
    EXPECT_NE(by_imu.reason.find(to_string(ground::CalibrationReason::no_observation)),
              std::string::npos);
    EXPECT_NE(by_imu.reason.find("more level floor"), std::string::npos) << "what to do";

    AlignmentConfig config;
    config.pitch_deg = 30.0;
    const Alignment assumed = place_odom(config, {}, std::nullopt);
    EXPECT_EQ(assumed.gravity_source, grid::GravitySource::assumed);
    for (const char* advice : {"machine file", "mount.pitch_deg", "more level floor"})
        EXPECT_NE(assumed.reason.find(advice), std::string::npos) << assumed.reason;
    // base_link looks 30 deg down: its x axis points below the horizon by that.
    const Eigen::Vector3d forward = assumed.T_odom_body.rotation * Eigen::Vector3d::UnitX();
    EXPECT_NEAR(std::asin(-forward.z()), 30 * kRadPerDeg, kRounding);
}

TEST(Alignment, a_base_link_that_looks_straight_down_has_a_finite_pose) {
    const Alignment a = place_odom({}, plane(-Eigen::Vector3d::UnitX(), 1.0), std::nullopt);
    EXPECT_TRUE(a.T_odom_body.all_finite());
    EXPECT_LT(
        (a.T_odom_body.rotation * -Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitZ()).norm(),
        kRounding);
}

TEST(UpFromImu, needs_a_rig_at_rest) {
    const Pose T_body_imu{Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY())),
                          Eigen::Vector3d::Zero()};
    const Eigen::Vector3d force(-9.80, 0.0, 0.0);  // the IMU's -x axis points up
    const auto up = up_from_imu({}, T_body_imu, resting_imu(force, {0.02, 0.0, 0.08}));
    ASSERT_TRUE(up.has_value());
    EXPECT_LT((*up - Eigen::Vector3d::UnitZ()).norm(), 1e-6);

    EXPECT_FALSE(up_from_imu({}, T_body_imu, resting_imu(force, {0.5, 0.0, 0.0})).has_value())
        << "turning";
    EXPECT_FALSE(
        up_from_imu({}, T_body_imu, resting_imu(1.1 * force, Eigen::Vector3d::Zero())).has_value())
        << "accelerating";
    EXPECT_FALSE(up_from_imu({}, T_body_imu, {}).has_value()) << "no IMU";
}

}  // namespace
}  // namespace surefoot::pipeline
