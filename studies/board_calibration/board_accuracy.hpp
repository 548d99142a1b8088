// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "service/console/option_settings.hpp"
#include "service/console/options.hpp"
#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/eval/depth/board_errors.hpp"

namespace surefoot::app {

/// Options of `surefoot depth-accuracy`.
struct DepthAccuracyOptions {
    CommonOptions common;
    std::string rig = "zed_vga";      ///< rig file or name of a built-in rig
    std::vector<double> distances_m;  ///< distances of the board [m]; empty = defaults
    int repeats = 3;  ///< number of rendered images per distance; texture and noise differ
    /// File with real images instead of rendered ones: lines "LEFT RIGHT DISTANCE_M".
    std::string pairs_file;
    double board_m = 0.6;  ///< side of the square textured board [m]
    std::string out_dir;
    bool design = false;      ///< true: compute the smallest resolvable height, without images
    double baseline_m = 0.0;  ///< --design: baseline [m]; 0 = baseline of the rig
    double focal_px = 0.0;    ///< --design: focal length [px]; 0 = focal length of the rig
    std::string size;         ///< --design: image size WIDTHxHEIGHT; empty = size of the rig
    double sigma_px = 0.0;    ///< --design: sigma of the disparity [px]; 0 = limit of our matcher
    double height_m = 1.0;    ///< --design: height of the camera above the floor [m]
    double pitch_deg = 32.0;  ///< --design: angle of the camera below the horizon [deg]
};

/// Depth accuracy that the reference thesis (Lange 2016, Table 4.1) measured with a commercial
/// camera on a flat textured board.
struct ThesisAccuracy {
    const char* camera;
    double distance_m;
    double axial_m;  ///< absolute error along the optical axis [m]
    double std_m;
};
[[nodiscard]] const std::vector<ThesisAccuracy>& thesis_accuracy();
/// Returns "ZED" or "DUO" if the name begins with "zed" or "duo"; otherwise nullopt.
[[nodiscard]] std::optional<std::string> thesis_camera(const std::string& rig_name);

/// Depth accuracy of a rig at one distance of the board.
struct DistanceAccuracy {
    double distance_m = 0.0;
    int observations = 0;                     ///< number of image pairs
    std::optional<eval::BoardErrors> errors;  ///< nullopt = the depth image shows no board
    double density_percent = 0.0;             ///< share of the board's pixels with trusted depth
    std::optional<ThesisAccuracy> thesis;     ///< value of the thesis for this camera and distance
};

/// Measures depth accuracy on rendered boards, or on the images that `options.pairs_file` lists.
///
/// Each line of that file is LEFT RIGHT DISTANCE_M; '#' begins a comment; paths are relative to
/// the file. The rows come in order of ascending distance.
[[nodiscard]] Result<std::vector<DistanceAccuracy>> measure_accuracy(
    const DepthAccuracyOptions& options,
    const Settings& settings,
    const camera::StereoRig& rig,
    Executor& executor);

}  // namespace surefoot::app
