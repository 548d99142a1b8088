// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace surefoot::app {

/// Nearest and farthest floor that a camera sees, ahead of base_link [m].
struct FloorView {
    double near_m = 0.0;
    double far_m = 0.0;  ///< infinite when the horizon is in view
};

/// What a rig on a machine can know of the ground: what `doctor` says.
struct RigView {
    struct Depth {
        double z_m = 0.0;
        double sigma_m = 0.0;
    };
    struct Step {
        int command = 0;
        std::string name;
        double toe_m = 0.0;       ///< farthest that the landing foot reaches, ahead of base_link
        bool remembered = false;  ///< all of it inside the blind zone: seen earlier, or never
    };
    std::string name;
    int width = 0;
    int height = 0;
    double focal_px = 0.0;
    double baseline_m = 0.0;
    double disparity_sigma_px = 0.0;  ///< for which the depths hold
    std::vector<Depth> depths;
    FloorView floor;
    std::vector<Step> steps;  ///< straight ahead
};

}  // namespace surefoot::app
