// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "service/console/options.hpp"

namespace surefoot::app {

/// Options of `surefoot sim`.
struct SimOptions {
    CommonOptions common;
    std::string scene;
    std::string out_dir;
    std::string rig;
    std::string machine = "rex";
    bool list = false;
    bool depth = false;
    int frames = 0;
    double rate_hz = 0.0;
    std::string scan_file;
    std::vector<std::string> stations;  ///< positions of the laser scanner, each "x,y,z" [m]
    double tile_m = 0.0;                ///< side of the square tiles of a scan [m]; 0 = one file
    std::string tile_format = "ply";
};

}  // namespace surefoot::app
