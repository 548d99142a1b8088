// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "apps/surefoot/thesis_figures.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/eval/clouds/m3c2.hpp"
#include "surefoot/eval/maps/maps.hpp"
#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/traversability_config.hpp"

namespace surefoot::app {

/// Heights and their rating on some cells.
struct RatedMap {
    grid::GridGeometry geometry;
    grid::Layer height_m;
    grid::Layer traversability;
};

/// The heights of a scan through the filters that rate a live map.
[[nodiscard]] RatedMap rated_map(const grid::GridGeometry& geometry,
                                 const grid::Layer& height_m,
                                 const traversability::TraversabilityConfig& config);

/// A point for each known cell, at its middle.
[[nodiscard]] std::vector<Eigen::Vector3f> cell_points_m(const RatedMap& map);

/// The layers of a live map read at the middle of each cell of the truth.
[[nodiscard]] RatedMap laid_onto(const RatedMap& truth,
                                 const RatedMap& live,
                                 const Pose& T_truth_live);

/// A live map laid onto the scan of its place and compared with it as 9.2 of the thesis does.
struct ComparedMap {
    RatedMap live;            ///< on the cells of the truth
    grid::Layer m3c2_m;       ///< live - truth along the vertical; NaN = none
    Image<eval::Call> calls;  ///< confusion of the ratings
    Pose T_truth_live;        ///< what the alignment found
    ThesisFigures figures;
};
/// The live map is laid onto the scan in height and tilt, by the differences of their cells: the
/// cells of a map have no upright faces that would say where it belongs along the ground, and there
/// both frames are that of the first base_link. What odometry drifted stays in the figures. They
/// are: align_m, align_deg, c2c_*, m3c2_*, height_*, edges_*, floor_spread_m, false_safe,
/// false_unsafe, known_cells. The live map must have a known cell.
[[nodiscard]] ComparedMap compare_with_scan(const RatedMap& live,
                                            const RatedMap& truth,
                                            const eval::M3c2Config& m3c2,
                                            const eval::EvalMapsConfig& maps);

/// A part of the ground.
struct GroundBox {
    Eigen::Vector2d low_m = Eigen::Vector2d::Zero();
    Eigen::Vector2d high_m = Eigen::Vector2d::Zero();
};

/// What one reads off a histogram of heights: riser_m, riser_se_m, riser_spread_m, risers,
/// first_riser_m, going_m, going_se_m; NaN where there is no stair.
void measure_stairs(std::span<const Eigen::Vector3f> points_m,
                    const GroundBox& box,
                    ThesisFigures& figures);
/// How many of the points in the box lie how high, as a picture; empty without points.
[[nodiscard]] std::string box_heights_svg(std::span<const Eigen::Vector3f> points_m,
                                          const GroundBox& box,
                                          const std::string& title);

/// door_width_m between what stands, and floor_step_m: the floor behind a door over that before it.
/// Points for the width, heights for the floors; the way through leads along +x.
void measure_door(std::span<const Eigen::Vector3f> points_m,
                  const RatedMap& map,
                  const Eigen::Vector2d& door_m,
                  ThesisFigures& figures);

}  // namespace surefoot::app
