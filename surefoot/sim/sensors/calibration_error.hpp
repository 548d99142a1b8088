// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/config.hpp"

namespace surefoot::sim {

/// Difference between the true right camera and its calibration, for example because the camera has
/// warmed up since. Rotations are about the axes of the left camera.
struct CalibrationError {
    double right_roll_rad = 0.0;     ///< about z (ahead): rows of both images cross
    double right_pitch_rad = 0.0;    ///< about x (to the right): rows are shifted
    double right_yaw_rad = 0.0;      ///< about y (down): every disparity has a bias
    double right_focal_share = 0.0;  ///< share by which the focal lengths are longer

    void describe(ConfigVisitor& visitor);
};

/// Returns the true rig that takes the images while all other code uses `nominal`.
[[nodiscard]] camera::StereoRig with_error(const camera::StereoRig& nominal,
                                           const CalibrationError& error);

}  // namespace surefoot::sim
