// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/ground_config.hpp"

namespace surefoot::ground {

void GroundConfig::describe(ConfigVisitor& visitor) {
    visitor.number("voxel_m",
                   voxel_m,
                   0.001,
                   1.0,
                   "side length of the cubes that thin out the points: the ground search uses one "
                   "point per cube");
    visitor.integer(
        "max_points", max_points, 50, 1000000, "largest number of points in the ground search");
    visitor.number(
        "max_range_m",
        max_range_m,
        0.2,
        1000.0,
        "largest distance of a point from the sensor; the ground search ignores farther points");
    visitor.number("tolerance_m",
                   tolerance_m,
                   0.001,
                   1.0,
                   "largest distance of an inlier from the ground plane");
    visitor.number(
        "max_tilt_deg",
        max_tilt_deg,
        0.1,
        89.0,
        "largest angle between the normal of the ground plane and the expected up direction");
    visitor.number("min_inlier_ratio",
                   min_inlier_ratio,
                   0.0,
                   1.0,
                   "smallest share of the points on the ground plane; a plane with a smaller share "
                   "is rejected");
    visitor.number("min_area_m2",
                   min_area_m2,
                   0.0,
                   1000.0,
                   "smallest area covered by the inliers of the ground plane");
    visitor.number("min_extent_m",
                   min_extent_m,
                   0.0,
                   100.0,
                   "smallest extent (one sigma) of the inliers along their narrow side");
    visitor.number("max_rms_m",
                   max_rms_m,
                   0.0001,
                   1.0,
                   "largest scatter (rms) of the inliers across the ground plane");
    visitor.number("min_height_m",
                   min_height_m,
                   0.0,
                   100.0,
                   "smallest height of the sensor above the ground plane");
    visitor.number("max_height_m",
                   max_height_m,
                   0.0,
                   100.0,
                   "largest height of the sensor above the ground plane");
    visitor.number("expected_height_m",
                   expected_height_m,
                   0.0,
                   5.0,
                   "expected height of base_link above its ground: of several planes, the search "
                   "takes the one whose height fits best. 0 = unknown: it takes the lower plane, "
                   "or of planes at most one high step (0.35 m) apart the nearer one");
    visitor.number("search_up_deg",
                   search_up_deg,
                   0.0,
                   60.0,
                   "unknown camera mount: largest angle of the optical axis above the horizon");
    visitor.number("search_down_deg",
                   search_down_deg,
                   0.0,
                   85.0,
                   "unknown camera mount: largest angle of the optical axis below the horizon; "
                   "above 65 deg the search may take a wall for the floor");
    visitor.number("search_roll_deg",
                   search_roll_deg,
                   0.0,
                   60.0,
                   "unknown camera mount: largest roll of the camera");
    visitor.number("min_image_share",
                   min_image_share,
                   0.0,
                   1.0,
                   "unknown camera mount: smallest share of the image that shows the ground");
    visitor.number(
        "max_search_sigma_deg",
        max_search_sigma_deg,
        0.01,
        30.0,
        "unknown camera mount: largest uncertainty (one sigma) of the tilt of the ground");
    visitor.number("max_search_rms_m",
                   max_search_rms_m,
                   0.001,
                   1.0,
                   "unknown camera mount: largest scatter (rms) of the ground, for example 0.023 m "
                   "on mulch or 0.04 m on boulders");
    visitor.integer(
        "window", window, 1, 1000, "number of the latest ground observations that are averaged");
    visitor.integer("min_agreeing",
                    min_agreeing,
                    1,
                    1000,
                    "smallest number of ground observations that must agree");
    visitor.number(
        "max_disagreement_deg",
        max_disagreement_deg,
        0.01,
        45.0,
        "largest difference between the tilts of two agreeing ground observations. If two sigma of "
        "the difference are larger, they replace this limit, up to twice the limit");
    visitor.number(
        "max_disagreement_m",
        max_disagreement_m,
        0.001,
        1.0,
        "largest difference between the heights of two agreeing ground observations. If two sigma "
        "of the difference are larger, they replace this limit, up to twice the limit");
}

}  // namespace surefoot::ground
