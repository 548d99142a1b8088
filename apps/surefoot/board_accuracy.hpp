// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/verbs.hpp"
#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/eval/depth/board_errors.hpp"

namespace surefoot::app {

/// What the thesis measured with a bought camera (Table 4.1: flat textured board).
struct ThesisAccuracy {
    const char* camera;
    double distance_m;
    double axial_m;  ///< absolute
    double std_m;
};
[[nodiscard]] const std::vector<ThesisAccuracy>& thesis_accuracy();
/// "ZED", "DUO", or nothing where the thesis has no such camera.
[[nodiscard]] std::optional<std::string> thesis_camera(const std::string& rig_name);

/// How far off a rig is at one distance.
struct DistanceAccuracy {
    double distance_m = 0.0;
    int looks = 0;                            ///< pairs of images
    std::optional<eval::BoardErrors> errors;  ///< nothing where no board was found in the depth
    double density_percent = 0.0;             ///< of the board's pixels that gave a trusted depth
    std::optional<ThesisAccuracy> thesis;     ///< of the same camera at the same distance
};

/// From rendered boards, or from the images of `options.pairs_file` (lines LEFT RIGHT DISTANCE_M;
/// '#' begins a comment; paths are relative to the file). Ascending distances.
[[nodiscard]] Result<std::vector<DistanceAccuracy>> measure_accuracy(
    const DepthAccuracyOptions& options,
    const Settings& settings,
    const camera::StereoRig& rig,
    Executor& executor);

}  // namespace surefoot::app
