// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/calibration_error.hpp"

#include "surefoot/camera/right_camera_correction.hpp"

namespace surefoot::sim {

void CalibrationError::describe(ConfigVisitor& visitor) {
    visitor.number("right_roll_rad",
                   right_roll_rad,
                   -0.2,
                   0.2,
                   "rotation error of the right camera about the optical axis");
    visitor.number("right_pitch_rad",
                   right_pitch_rad,
                   -0.2,
                   0.2,
                   "rotation error of the right camera about the row direction");
    visitor.number("right_yaw_rad",
                   right_yaw_rad,
                   -0.2,
                   0.2,
                   "rotation error of the right camera about the column direction");
    visitor.number("right_focal_share",
                   right_focal_share,
                   -0.1,
                   0.1,
                   "relative error of the focal lengths of the right camera; positive = longer");
}

camera::StereoRig with_error(const camera::StereoRig& nominal, const CalibrationError& error) {
    return camera::with_right_camera(nominal,
                                     {error.right_roll_rad,
                                      error.right_pitch_rad,
                                      error.right_yaw_rad,
                                      error.right_focal_share});
}

}  // namespace surefoot::sim
