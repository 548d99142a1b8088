// SPDX-License-Identifier: Apache-2.0
#include "service/live/page_telemetry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "surefoot/camera/rigs_testing.hpp"

namespace surefoot::app {
namespace {

/// A camera 0.05 m above base_link, 0.1 m ahead of it and 0.25 m to its left. It points ahead and
/// down.
camera::RectifiedRig rig_that_looks_down(double pitch_deg) {
    camera::StereoRig rig = camera::test::ideal_rig(640, 480, 400.0);
    const double pitch = pitch_deg * std::numbers::pi / 180.0;
    Eigen::Matrix3d R_body_left;  // optical axes: x right, y down, z ahead
    R_body_left.col(0) = -Eigen::Vector3d::UnitY();
    R_body_left.col(2) = Eigen::Vector3d(std::cos(pitch), 0.0, -std::sin(pitch));
    R_body_left.col(1) = R_body_left.col(2).cross(R_body_left.col(0));
    rig.T_body_left = Pose{Eigen::Quaterniond(R_body_left), {0.1, 0.25, 0.05}};
    return camera::Rectifier::make(rig).value().rig();
}

TEST(BlindZone, EndsWhereTheLowestRayMeetsTheFloor) {
    const camera::RectifiedRig rig = rig_that_looks_down(30.0);
    const auto zone = blind_zone_of(rig, 0.99);
    ASSERT_EQ(zone.size(), 4U);
    // Height over the floor 1.04 m; the last row looks 30 deg and half of the field of view down.
    const double down =
        30.0 * std::numbers::pi / 180.0 + std::atan((479.0 - rig.cy_px) / rig.fy_px);
    EXPECT_NEAR(zone[0].x_m, 0.1 + 1.04 / std::tan(down), 1e-3);
    EXPECT_NEAR(zone[1].x_m, zone[0].x_m, 1e-9);
    EXPECT_LT(zone[0].y_m, 0.25);  // right column first: counter-clockwise
    EXPECT_GT(zone[1].y_m, 0.25);
    EXPECT_DOUBLE_EQ(zone[2].x_m, 0.0);
    EXPECT_DOUBLE_EQ(zone[2].y_m, zone[1].y_m);
    EXPECT_DOUBLE_EQ(zone[3].y_m, zone[0].y_m);
}

TEST(BlindZone, IsNoneWhereNoFloorIsInView) {
    EXPECT_TRUE(blind_zone_of(rig_that_looks_down(-60.0), 0.99).empty());
}

}  // namespace
}  // namespace surefoot::app
