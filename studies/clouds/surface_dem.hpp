// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/elevation/fusion/cell_reduction.hpp"
#include "surefoot/eval/maps/dem.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::app {

/// Rules that turn a cloud into ground heights. They are the rules of the live map
/// (`elevation::reduce_cell`), for points without a variance.
struct SurfaceRules {
    elevation::ReductionConfig reduction;
    double point_sigma_m = 0.005;  ///< standard deviation of one point's height [m]
    /// A gap of this height separates overhanging points from a surface.
    double min_overhead_m = 0.3;
    double lowest_z_m = -std::numeric_limits<double>::infinity();  ///< lower points are left out
    double highest_z_m = std::numeric_limits<double>::infinity();  ///< higher points are left out
};

/// Ground heights of a cloud; NaN = no supported surface.
struct SurfaceDem {
    grid::Layer height_m;
    grid::Layer clearance_m;             ///< height from ground to lowest overhanging points [m]
    std::int64_t cut_points = 0;         ///< number of points outside the height limits
    std::int64_t unsupported_cells = 0;  ///< number of cells with points but no supported surface
    std::int64_t overhung_cells = 0;
};

/// Calls the function with all points of a cloud, block by block. All calls must deliver the same
/// points.
using EachBlock =
    std::function<Status(const std::function<Status(std::span<const Eigen::Vector3d>)>&)>;

/// Finds the ground of each cell: the highest supported surface that does not overhang.
///
/// Gaps of at least `min_overhead_m` split the heights of a cell into groups. The ground lies in
/// the lowest group that has a surface. If other points lie above the group, a surface needs at
/// least twice the minimum number of points, because mirror images lie below a floor. Within the
/// group the ground is the highest surface that enough points share and that is denser than a
/// uniform scatter of the group. A surface is removed if it has less than a fifth of the points of
/// the cells around it (upper quartile): points in flight between two surfaces are scattered or
/// few. A cell with fewer points than a surface needs also counts the points of its neighbour
/// cells. The result does not depend on the order of the points or on the number of threads.
///
/// Reads the cloud once to count, and once more for each 2^25 points. Memory grows with the number
/// of cells, plus at most 0.5 GB or the need of the fullest row of cells.
[[nodiscard]] Result<SurfaceDem> surface_dem(const eval::DemGrid& grid,
                                             const SurfaceRules& rules,
                                             const EachBlock& each_block,
                                             Executor& executor = serial());

/// Returns the rules for --min-height and --max-height. The error names both options if the lower
/// limit is not below the upper limit.
[[nodiscard]] Result<SurfaceRules> surface_rules(std::optional<double> lowest_z_m,
                                                 std::optional<double> highest_z_m);

/// Returns a text about left-out points, unknown cells and overhung cells; empty if none exist.
[[nodiscard]] std::string left_out_text(const SurfaceDem& dem);

}  // namespace surefoot::app
