// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/config.hpp"

namespace surefoot::ground {

/// Limits for accepting a plane as the ground, and for accepting a calibration.
struct GroundConfig {
    double voxel_m = 0.05;           ///< side of cubes; the search uses one point of each cube
    int max_points = 4000;           ///< largest number of points, picked evenly
    double max_range_m = 8.0;        ///< largest range; stereo noise tilts farther ground
    double tolerance_m = 0.05;       ///< largest distance of an inlier, before the refit narrows it
    double max_tilt_deg = 20.0;      ///< largest tilt from the hint: mount error plus slope
    double min_inlier_ratio = 0.15;  ///< smallest share of the points; a floor may be cluttered
    double min_area_m2 = 0.3;        ///< smallest occupied area; two soles cover 0.14 m2
    double min_extent_m = 0.12;      ///< smallest sigma on the narrow side; wall slices have less
    double max_rms_m = 0.025;        ///< largest rms; clutter has tolerance_m / sqrt(3) = 0.029 m
    double min_height_m = 0.1;       ///< smallest height of the sensor above the plane
    double max_height_m = 3.0;
    double expected_height_m =
        0.0;  ///< height of base_link over its ground (machine file); 0 = unknown

    /// Search without a known camera mount (ground_search.hpp): limits of the optical axis above
    /// and below the horizon, and of roll. At steeper angles a wall resembles a floor.
    double search_up_deg = 10.0;
    double search_down_deg = 65.0;
    double search_roll_deg = 20.0;
    double min_image_share = 0.04;      ///< smallest share of pixels; half a floor may lack depth
    double max_search_sigma_deg = 1.2;  ///< largest sigma of the tilt; a strip fixes only one axis
    double max_search_rms_m = 0.045;    ///< largest scatter; boulders of 0.1 m scatter by 0.04 m

    int window = 10;                    ///< number of the latest observations in the average
    int min_agreeing = 5;               ///< number of these observations that must agree
    double max_disagreement_deg = 1.5;  ///< observations farther from the others are left out
    double max_disagreement_m = 0.03;

    void describe(ConfigVisitor& visitor);
};

}  // namespace surefoot::ground
