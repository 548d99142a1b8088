// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::sim {

/// Height of base_link of a trolley above the ground; the cameras are 0.05 m higher.
inline constexpr double kBodyHeight_m = 0.95;

/// Pose of a left camera that points straight ahead, `pitch_down_rad` below the horizon.
[[nodiscard]] Pose looking_down(const Eigen::Vector3d& position_body_m, double pitch_down_rad);

/// Names of the built-in rigs.
[[nodiscard]] std::vector<std::string> rig_presets();

/// A rig on the left armrest of the machine, 0.05 m above base_link, 32 deg down, with an IMU
/// midway between the cameras. An unknown name is a usage error that lists the names.
///   zed_vga, zed_hd720, zed_hd1080, zed_hd2k   the ZED's modes with ideal, rectified images
///   the same names plus `_rolling`             the same modes, rows read out in turn (`readout_s`)
///   duo_mlx                                    fisheye pair with a baseline of 30 mm, raw images
[[nodiscard]] Result<camera::StereoRig> rig_preset(const std::string& name);

}  // namespace surefoot::sim
