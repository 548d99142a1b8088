// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace surefoot::app {

/// Range of the floor that a camera sees, ahead of base_link [m].
struct FloorView {
    double near_m = 0.0;
    double far_m = 0.0;  ///< infinite when the horizon is in view
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
        double toe_m = 0.0;       ///< farthest point of the landing foot, ahead of base_link
        bool remembered = false;  ///< the whole landing area lies in the blind zone; the map must
                                  ///< hold it from earlier frames
    };
    std::string name;
    int width = 0;
    int height = 0;
    double focal_px = 0.0;
    double baseline_m = 0.0;
    double disparity_sigma_px = 0.0;  ///< disparity precision that `depths` assumes
    std::vector<Depth> depths;
    FloorView floor;
    std::vector<Step> steps;  ///< steps straight ahead
};

}  // namespace surefoot::app
