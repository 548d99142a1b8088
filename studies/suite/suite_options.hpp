// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "service/console/options.hpp"

namespace surefoot::app {

/// Options of `surefoot eval suite`.
struct EvalSuiteOptions {
    CommonOptions common;  ///< `seed` is the first seed of the cases
    std::string out_dir;
    std::string machine = "rex";
    std::string camera = "zed";       ///< camera profile, one of sim::kCameraProfileNames
    std::string rig;                  ///< rig file, or one of sim::rig_presets(); empty = zed_vga
    std::vector<std::string> scenes;  ///< empty = all
    /// Motion models of the cases, each one of sim::kMotionModelChoiceNames.
    std::vector<std::string> motion_models = {"scene"};
    int seeds = 1;                           ///< number of seeds for each scene
    std::vector<double> noise = {1.0, 2.0};  ///< factors on the noise amplitude of the camera
    bool quick = false;
    int frames = 0;        ///< largest number of frames of each case; 0 = the whole path
    double reach_m = 0.8;  ///< largest distance of a queried pose from the last pose [m]
    bool thesis = false;   ///< true: run the experiments of the reference thesis (Lange 2016)
    std::vector<std::string> runs;  ///< names of thesis experiments; empty = all
};

}  // namespace surefoot::app
