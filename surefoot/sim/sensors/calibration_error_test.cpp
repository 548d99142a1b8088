// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/calibration_error.hpp"

#include <gtest/gtest.h>

#include "surefoot/sim/sensors/rigs.hpp"

namespace surefoot::sim {
namespace {

/// Actual minus expected pixel of the right camera for a point that is at `p_left_m` in the left
/// camera.
Eigen::Vector2d displacement_px(const CalibrationError& error, const Eigen::Vector3d& p_left_m) {
    const camera::StereoRig nominal = *rig_preset("zed_vga");
    const camera::StereoRig real = with_error(nominal, error);
    const auto seen = [&](const camera::StereoRig& rig) {
        return *camera::project(rig.right->model, rig.T_left_right.inverse() * p_left_m);
    };
    return seen(real) - seen(nominal);
}

constexpr double kSmall_rad = 1e-3;
constexpr double kFocal_px = 342.0;
const Eigen::Vector3d kFar(0.0, 0.0, 1000.0);
const Eigen::Vector3d kFarRight(500.0, 0.0, 1000.0);

TEST(CalibrationErrorTest, PitchShiftsRowsYawShiftsDisparities) {
    CalibrationError pitch;
    pitch.right_pitch_rad = kSmall_rad;
    EXPECT_NEAR(displacement_px(pitch, kFar).y(), kFocal_px * kSmall_rad, 1e-3);
    EXPECT_NEAR(displacement_px(pitch, kFar).x(), 0.0, 1e-3);
    CalibrationError yaw;
    yaw.right_yaw_rad = kSmall_rad;
    EXPECT_NEAR(displacement_px(yaw, kFar).x(), -kFocal_px * kSmall_rad, 1e-3);
    EXPECT_NEAR(displacement_px(yaw, kFar).y(), 0.0, 1e-3);
}

TEST(CalibrationErrorTest, RollCrossesRowsAndALongerLensMagnifies) {
    CalibrationError roll;
    roll.right_roll_rad = kSmall_rad;
    EXPECT_NEAR(displacement_px(roll, kFarRight).y(), -0.5 * kFocal_px * kSmall_rad, 1e-3);
    EXPECT_NEAR(displacement_px(roll, kFar).norm(), 0.0, 1e-3);
    CalibrationError longer;
    longer.right_focal_share = kSmall_rad;
    EXPECT_NEAR(displacement_px(longer, kFarRight).x(), 0.5 * kFocal_px * kSmall_rad, 1e-3);
}

TEST(CalibrationErrorTest, NoErrorLeavesTheViewAlone) {
    EXPECT_EQ(displacement_px({}, {0.3, -0.2, 1.5}).norm(), 0.0);
}

}  // namespace
}  // namespace surefoot::sim
