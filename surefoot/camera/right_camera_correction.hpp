// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/camera/stereo_rig.hpp"

namespace surefoot::camera {

/// How a right eye differs from its calibration: a camera that was calibrated on another day,
/// warmed up or was knocked since. Turns are about the axes of the left camera.
struct RightCameraCorrection {
    double roll_rad = 0.0;     ///< about z, ahead: rows cross
    double pitch_rad = 0.0;    ///< about x, to the right: rows are shifted
    double yaw_rad = 0.0;      ///< about y, down: a bias of every disparity
    double focal_share = 0.0;  ///< focal lengths are this share longer
};

/// The rig with its right eye changed. Its images are no longer rectified.
[[nodiscard]] StereoRig with_right_camera(const StereoRig& nominal,
                                          const RightCameraCorrection& this_camera);

}  // namespace surefoot::camera
