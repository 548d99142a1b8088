// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/config.hpp"

namespace surefoot::ground {

/// When a plane counts as the ground, and when several sightings of it count as calibrated.
struct GroundConfig {
    double voxel_m = 0.05;           ///< one point per cube: support by area, not by pixels
    int max_points = 4000;           ///< evenly picked from those that remain
    double max_range_m = 8.0;        ///< stereo noise tilts far ground
    double tolerance_m = 0.05;       ///< inliers of the search; the refit then narrows to the noise
    double max_tilt_deg = 20.0;      ///< from the hint; must cover mount error plus slope
    double min_inlier_ratio = 0.15;  ///< floor between walls and furniture
    double min_area_m2 = 0.3;        ///< of occupied squares; two soles cover 0.14
    double min_extent_m = 0.12;      ///< narrow one-sigma extent; slices through walls are thinner
    double max_rms_m = 0.025;        ///< clutter cut by a slab has tolerance / sqrt(3) = 0.029
    double min_height_m = 0.1;       ///< of the sensor above the plane
    double max_height_m = 3.0;
    double expected_height_m =
        0.0;  ///< of base_link over its own ground (machine file); 0 = unknown

    int window = 10;                    ///< last sightings that are averaged
    int min_agreeing = 5;               ///< of them, to be accepted
    double max_disagreement_deg = 1.5;  ///< a sighting farther from the others is left out
    double max_disagreement_m = 0.03;

    void describe(ConfigVisitor& visitor);
};

}  // namespace surefoot::ground
