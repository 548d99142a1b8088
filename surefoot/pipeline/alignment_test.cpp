// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/core/angles.hpp"

namespace surefoot::pipeline {
namespace {

constexpr double kRounding = 1e-9;

/// Returns the up direction in a base_link that is pitched down and rolled.
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

/// Direction measured by an accelerometer with an error of 0.12 deg.
Direction measured(const Eigen::Vector3d& up) {
    constexpr double kSigma_rad = 0.002;
    return {up, kSigma_rad * kSigma_rad * (Eigen::Matrix3d::Identity() - up * up.transpose())};
}

TEST(Alignment, puts_odom_on_the_plane_under_base_link_with_its_heading) {
    const Eigen::Vector3d up = up_in_body(32 * kRadPerDeg, 4 * kRadPerDeg);
    const Alignment a = place_odom({}, plane(up, 1.2), std::nullopt);
    EXPECT_EQ(a.gravity_source, grid::GravitySource::plane);
    EXPECT_LT((a.T_odom_body.rotation * up - Eigen::Vector3d::UnitZ()).norm(), kRounding);
    EXPECT_NEAR(yaw_rad(a.T_odom_body), 0.0, kRounding);
    EXPECT_LT((a.T_odom_body.translation_m - Eigen::Vector3d(0, 0, 1.2)).norm(), kRounding);
}

TEST(Alignment, takes_gravity_from_the_accelerometer_on_a_slope_and_the_height_along_it) {
    for (const double slope_deg : {1.146, 2.9, 4.76, 15.0}) {  // 1:50, 1:20, 1:12, a hillside
        SCOPED_TRACE(slope_deg);
        const Eigen::Vector3d normal = up_in_body(slope_deg * kRadPerDeg, 0.0);
        const Alignment a = place_odom({}, plane(normal, 1.0), measured(Eigen::Vector3d::UnitZ()));
        EXPECT_EQ(a.gravity_source, grid::GravitySource::imu);
        const Eigen::Vector3d up_odom = a.T_odom_body.rotation * Eigen::Vector3d::UnitZ();
        EXPECT_LT(up_odom.head<2>().norm(), 0.15 * kRadPerDeg);
        EXPECT_NEAR(a.ground_height_m, 1.0 / std::cos(slope_deg * kRadPerDeg), 1e-3);
        EXPECT_NEAR(a.ground_lean_rad, slope_deg * kRadPerDeg, 0.15 * kRadPerDeg);
        EXPECT_NEAR(a.tilt_sigma_rad, 0.002, 0.0003);
    }
}

TEST(Alignment, says_how_sure_the_vertical_is) {
    const Eigen::Vector3d up = up_in_body(0.4, 0.0);
    const Alignment by_both = place_odom({}, plane(up, 1.0), measured(up));
    EXPECT_LT(by_both.tilt_sigma_rad, 0.0018) << "a level floor corrects the accelerometer";
    EXPECT_NE(by_both.reason.find("1 sigma 0.0"), std::string::npos) << by_both.reason;
    const Alignment by_imu = place_odom({}, {}, measured(up));
    EXPECT_NEAR(by_imu.tilt_sigma_rad, 0.002, 1e-9);
    EXPECT_NE(by_imu.reason.find("1 sigma 0.11 deg"), std::string::npos) << by_imu.reason;
    const Alignment by_plane = place_odom({}, plane(up, 1.0), std::nullopt);
    EXPECT_GE(by_plane.tilt_sigma_rad, 1.4 * kRadPerDeg) << "any floor may slope";
    EXPECT_NE(by_plane.reason.find("1 sigma of the vertical 1.4 deg"), std::string::npos)
        << by_plane.reason;
    EXPECT_TRUE(std::isnan(place_odom({}, {}, std::nullopt).tilt_sigma_rad));
    EXPECT_TRUE(std::isnan(place_odom({}, plane(up, 2.0), measured(up), 1.0).tilt_sigma_rad))
        << "a wrong scale is a wrong everything";
}

TEST(Alignment, a_search_says_what_it_saw_and_what_to_do) {
    GroundView look{true, 60.0, 0.09, ground::GroundReason::few_inliers};
    const Alignment failed = place_odom({}, {}, std::nullopt, 0.0, look);
    for (const char* words : {"tilt 0-60 deg was searched",
                              "9 % of the image looks like floor",
                              "point the camera lower",
                              "mount.pitch_deg"})
        EXPECT_NE(failed.reason.find(words), std::string::npos) << failed.reason;
    look.reason = ground::GroundReason::not_lowest;
    EXPECT_NE(place_odom({}, {}, std::nullopt, 0.0, look).reason.find("far below it"),
              std::string::npos);
    const Alignment found = place_odom({}, plane({0.0, 0.0, 1.0}, 1.0), std::nullopt, 0.0, look);
    EXPECT_EQ(found.gravity_source, grid::GravitySource::plane);
    EXPECT_NE(found.reason.find("mounting unknown"), std::string::npos) << found.reason;
}

TEST(Alignment, a_ground_where_the_machine_cannot_stand_is_a_wrong_scale) {
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    for (const auto& up_imu : {std::optional<Direction>(), std::optional(measured(up))}) {
        for (const double height_m : {2.0, 0.5}) {  // twice or half the baseline
            const Alignment a = place_odom({}, plane(up, height_m), up_imu, 1.0);
            EXPECT_EQ(a.gravity_source, grid::GravitySource::assumed);
            EXPECT_NE(a.reason.find("baseline"), std::string::npos);
        }
        const Alignment kerb = place_odom({}, plane(up, 1.2), up_imu, 1.0);
        EXPECT_EQ(kerb.gravity_source,
                  up_imu ? grid::GravitySource::imu : grid::GravitySource::plane);
    }
}

TEST(Alignment, without_a_plane_stays_at_base_link_and_says_what_it_used) {
    const Alignment by_imu = place_odom({}, {}, measured(up_in_body(0.3, 0.1)));
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
    // base_link is pitched down by 30 deg, so its x axis points 30 deg below the horizon.
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

}  // namespace
}  // namespace surefoot::pipeline
