// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/camera/stereo_rig.hpp"

namespace surefoot::camera {

/// Deviation of the right camera from its calibration, for example after warm-up, after a shock or
/// after a long time. Rotations are about the axes of the left camera.
struct RightCameraCorrection {
    double roll_rad = 0.0;     ///< about z (forward): tilts the rows of the right image
    double pitch_rad = 0.0;    ///< about x (to the right): shifts the rows
    double yaw_rad = 0.0;      ///< about y (down): biases every disparity
    double focal_share = 0.0;  ///< relative increase of the focal lengths
};

/// Returns the rig with a corrected right camera. The images of this rig are not rectified.
[[nodiscard]] StereoRig with_right_camera(const StereoRig& nominal,
                                          const RightCameraCorrection& this_camera);

}  // namespace surefoot::camera
