// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace surefoot::app {

/// Nearest and farthest level floor in the middle image column: distances ahead of base_link [m].
struct FloorView {
    double near_m = 0.0;
    double far_m = 0.0;  ///< infinite if the horizon is in view
};

/// Predicted view of a rig that is mounted on a machine, as `surefoot doctor` prints it.
struct RigView {
    struct Depth {
        double z_m = 0.0;
        double sigma_m = 0.0;
    };
    struct Step {
        int command = 0;
        std::string name;
        double toe_m = 0.0;       ///< farthest point of the landed foot, ahead of base_link
        bool remembered = false;  ///< true = the whole landing area is in the blind zone.
                                  ///< The map must then contain this area from earlier frames.
    };
    std::string name;
    int width = 0;
    int height = 0;
    int coarse_width = 0;  ///< size at which every frame is matched (pipeline::FineConfig)
    int coarse_height = 0;
    double focal_px = 0.0;
    double baseline_m = 0.0;
    double disparity_sigma_px = 0.0;  ///< assumed standard deviation of a disparity
    std::vector<Depth> depths;
    FloorView floor;
    std::vector<Step> steps;  ///< movements straight ahead
};

}  // namespace surefoot::app
