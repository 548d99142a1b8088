// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "studies/lange2016/thesis_figures.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/eval/clouds/m3c2.hpp"
#include "surefoot/eval/maps/maps.hpp"
#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/traversability_config.hpp"

namespace surefoot::app {

/// Heights and their traversability on a grid.
struct RatedMap {
    grid::GridGeometry geometry;
    grid::Layer height_m;
    grid::Layer traversability;
};

/// Rates the heights of a scan with the filters of the live map.
[[nodiscard]] RatedMap rated_map(const grid::GridGeometry& geometry,
                                 const grid::Layer& height_m,
                                 const traversability::TraversabilityConfig& config);

/// Returns one point at the centre of each known cell.
[[nodiscard]] std::vector<Eigen::Vector3f> cell_points_m(const RatedMap& map);

/// Samples the layers of a live map at the centre of each cell of the truth.
[[nodiscard]] RatedMap laid_onto(const RatedMap& truth,
                                 const RatedMap& live,
                                 const Pose& T_truth_live);

/// A live map that is aligned with the scan of its place and compared with it. The comparison
/// follows section 9.2 of the reference thesis (Lange 2016).
struct ComparedMap {
    RatedMap live;            ///< live map on the grid of the truth
    grid::Layer m3c2_m;       ///< live - truth along the vertical [m]; NaN = no value
    Image<eval::Call> calls;  ///< live rating compared with the scan, cell by cell
    Pose T_truth_live;        ///< pose found by the alignment
    ThesisFigures figures;
};
/// Aligns the live map with the scan in height and tilt, from the height differences of their
/// cells, and compares the two. Horizontal alignment is not estimated: the cells of a map have no
/// vertical faces that would constrain it, and both frames are those of the first base_link.
/// Odometry drift therefore stays in the figures.
///
/// Figures: align_m, align_deg, c2c_*, m3c2_*, height_*, edges_*, floor_spread_m, false_safe,
/// false_unsafe, known_cells. The live map must have a known cell.
[[nodiscard]] ComparedMap compare_with_scan(const RatedMap& live,
                                            const RatedMap& truth,
                                            const eval::M3c2Config& m3c2,
                                            const eval::EvalMapsConfig& maps);

/// A rectangle on the ground.
struct GroundBox {
    Eigen::Vector2d low_m = Eigen::Vector2d::Zero();
    Eigen::Vector2d high_m = Eigen::Vector2d::Zero();
};

/// Measures a staircase by the histogram of heights. Sets riser_m, riser_se_m, riser_spread_m,
/// risers (0 = none), first_riser_m, going_m, going_se_m, going_spread_m. NaN = not found.
void measure_stairs(std::span<const Eigen::Vector3f> points_m,
                    const GroundBox& box,
                    ThesisFigures& figures);
/// Returns the histogram of the heights of the points in the box as SVG; empty without points.
[[nodiscard]] std::string box_heights_svg(std::span<const Eigen::Vector3f> points_m,
                                          const GroundBox& box,
                                          const std::string& title);

/// Measures a door that is passed along +x. Sets door_width_m, the clear width between the jambs.
/// Sets floor_step_m, the floor height behind the door minus the height in front of it. `points_m`
/// give the width, `map` gives the floors.
void measure_door(std::span<const Eigen::Vector3f> points_m,
                  const RatedMap& map,
                  const Eigen::Vector2d& door_m,
                  ThesisFigures& figures);

}  // namespace surefoot::app
