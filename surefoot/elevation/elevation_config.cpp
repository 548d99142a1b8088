// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/elevation_config.hpp"

#include <fmt/format.h>

namespace surefoot::elevation {
namespace {

constexpr double kMaxSideCells = 4096.0;  ///< 16.8 million cells; their layers take 1.2 GB

}  // namespace

void ElevationConfig::describe(ConfigVisitor& visitor) {
    visitor.number("resolution_m", resolution_m, 0.001, 10.0, "side length of a map cell");
    visitor.number(
        "length_m", length_m, 0.1, 1000.0, "side length of the square map around the machine");
    visitor.number(
        "camera_tilt_sigma_rad",
        camera_tilt_sigma_rad,
        0.0,
        1.0,
        "standard deviation of the camera's roll and pitch error in one frame, caused by "
        "mounting and vibration");
    visitor.number("min_overhead_m",
                   min_overhead_m,
                   0.05,
                   100.0,
                   "smallest height above a cell at which a surface counts as overhead; an "
                   "overhead surface limits the clearance of the cell");
    fusion.describe(visitor);
    visitor.group("reduction", reduction);
    visitor.group("sensor", sensor);
    visitor.group("pixels", pixels);
    visitor.group("prefilter", prefilter);
    visitor.group("viewpoint", viewpoint);
    visitor.group("visibility", visibility);
    visitor.group("height_drift", height_drift);
}

std::optional<std::string> ElevationConfig::problem() const {
    if (!(resolution_m > 0.0 && length_m >= resolution_m)) {
        return fmt::format(
            "elevation.length_m = {} must be at least elevation.resolution_m = {}: choose a longer "
            "map or smaller cells",
            length_m,
            resolution_m);
    }
    if (length_m / resolution_m > kMaxSideCells) {
        return fmt::format(
            "elevation.length_m = {} at elevation.resolution_m = {} makes {:.0f} cells per side, "
            "more "
            "than {:.0f}: choose a shorter map or larger cells",
            length_m,
            resolution_m,
            length_m / resolution_m,
            kMaxSideCells);
    }
    if (prefilter.range && !(prefilter.min_range_m < prefilter.max_range_m)) {
        return fmt::format(
            "elevation.prefilter.min_range_m = {} must be below elevation.prefilter.max_range_m = "
            "{}",
            prefilter.min_range_m,
            prefilter.max_range_m);
    }
    if (prefilter.height && !(prefilter.min_height_m < prefilter.max_height_m)) {
        return fmt::format(
            "elevation.prefilter.min_height_m = {} must be below elevation.prefilter.max_height_m "
            "= {}",
            prefilter.min_height_m,
            prefilter.max_height_m);
    }
    return fusion.problem();
}

}  // namespace surefoot::elevation
