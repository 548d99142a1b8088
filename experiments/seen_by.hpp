// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sim/scene_source.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::experiments {

/// Sets the camera's errors to those of a profile of the simulator, or of `zed_calibrated`: zed
/// without its error of calibration. A usage error names a profile that is none.
[[nodiscard]] inline Status see_by(const std::string& name, sim::SceneOptions& options) {
    const bool calibrated = name == "zed_calibrated";
    for (int i = 0; i < static_cast<int>(std::size(sim::kCameraProfileNames)); ++i) {
        if ((calibrated ? "zed" : name) != sim::kCameraProfileNames[i]) continue;
        options.profile = static_cast<sim::CameraProfile>(i);
        if (!calibrated) return {};
        const sim::CalibrationError error = sim::figures_of(options.profile).calibration;
        options.calibration_error = {.right_roll_rad = -error.right_roll_rad,
                                     .right_pitch_rad = -error.right_pitch_rad,
                                     .right_yaw_rad = -error.right_yaw_rad,
                                     .right_focal_share = -error.right_focal_share};
        return {};
    }
    return usage_error("there is no profile " + name);
}

}  // namespace surefoot::experiments
