// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "service/console/options.hpp"

namespace surefoot::app {

/// Options of `surefoot run`.
struct RunOptions : SourceOptions {
    CommonOptions common;
    std::string out_dir;
    std::string machine;
    int depth_every = 1;
    bool all_layers = false;
    std::string save_map;  ///< file for the whole map; empty = not saved
    std::string place;     ///< file of the place database; empty = no place recognition
};

}  // namespace surefoot::app
