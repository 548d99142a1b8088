// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/config.hpp"

namespace surefoot::sim {

/// How the right eye really is, compared with what its calibration says: a stereo camera that was
/// calibrated on another day, or warmed up since. Turns are about the axes of the left camera.
struct CalibrationError {
    double right_roll_rad = 0.0;     ///< about z, ahead: rows cross
    double right_pitch_rad = 0.0;    ///< about x, to the right: rows are shifted
    double right_yaw_rad = 0.0;      ///< about y, down: a bias of every disparity
    double right_focal_share = 0.0;  ///< focal lengths are this share longer

    void describe(ConfigVisitor& visitor);
};

/// The rig that takes the images when `nominal` is what everybody believes.
[[nodiscard]] camera::StereoRig with_error(const camera::StereoRig& nominal,
                                           const CalibrationError& error);

}  // namespace surefoot::sim
