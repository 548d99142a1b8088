// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/ground_config.hpp"

namespace surefoot::ground {

void GroundConfig::describe(ConfigVisitor& visitor) {
    visitor.number("voxel_m", voxel_m, 0.001, 1.0, "one point per cube of this size is used");
    visitor.integer(
        "max_points", max_points, 50, 1000000, "largest number of points in the search");
    visitor.number(
        "max_range_m", max_range_m, 0.2, 1000.0, "points farther from the sensor are left out");
    visitor.number(
        "tolerance_m", tolerance_m, 0.001, 1.0, "largest distance of an inlier from the plane");
    visitor.number(
        "max_tilt_deg", max_tilt_deg, 0.1, 89.0, "largest angle between normal and expected up");
    visitor.number(
        "min_inlier_ratio", min_inlier_ratio, 0.0, 1.0, "least share of the points on the plane");
    visitor.number("min_area_m2", min_area_m2, 0.0, 1000.0, "least area covered by inliers");
    visitor.number(
        "min_extent_m", min_extent_m, 0.0, 100.0, "least one-sigma extent across the narrow side");
    visitor.number(
        "max_rms_m", max_rms_m, 0.0001, 1.0, "largest scatter of the inliers across the plane");
    visitor.number(
        "min_height_m", min_height_m, 0.0, 100.0, "least height of the sensor above the plane");
    visitor.number(
        "max_height_m", max_height_m, 0.0, 100.0, "largest height of the sensor above the plane");
    visitor.number(
        "expected_height_m",
        expected_height_m,
        0.0,
        5.0,
        "height of base_link above its ground; of several planes the one at this height wins, "
        "not a landing below it. 0 = unknown: the lowest plane wins");
    visitor.number("search_up_deg",
                   search_up_deg,
                   0.0,
                   60.0,
                   "unknown camera mount: largest angle of the optical axis above the horizon");
    visitor.number("search_down_deg",
                   search_down_deg,
                   0.0,
                   85.0,
                   "unknown camera mount: largest angle below the horizon; beyond 65 a wall may "
                   "pass as floor");
    visitor.number(
        "search_roll_deg", search_roll_deg, 0.0, 60.0, "unknown camera mount: largest roll");
    visitor.number("min_image_share",
                   min_image_share,
                   0.0,
                   1.0,
                   "unknown camera mount: least share of the image on the ground");
    visitor.number("max_search_sigma_deg",
                   max_search_sigma_deg,
                   0.01,
                   30.0,
                   "unknown camera mount: largest one sigma of the ground's tilt");
    visitor.number(
        "max_search_rms_m",
        max_search_rms_m,
        0.001,
        1.0,
        "unknown camera mount: largest scatter of the ground (mulch 0.023, boulders 0.04)");
    visitor.integer(
        "window", window, 1, 1000, "number of last ground observations that are averaged");
    visitor.integer(
        "min_agreeing", min_agreeing, 1, 1000, "least number of observations that must agree");
    visitor.number(
        "max_disagreement_deg",
        max_disagreement_deg,
        0.01,
        45.0,
        "observations agree if their tilts differ by at most this, or by at most their two "
        "sigma where this is larger (limited to twice this value)");
    visitor.number(
        "max_disagreement_m", max_disagreement_m, 0.001, 1.0, "the same for their heights");
}

}  // namespace surefoot::ground
