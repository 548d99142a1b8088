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

/// How a cloud becomes ground: the rules of the live map (`elevation::reduce_cell`), for points
/// whose variance nobody gave.
struct SurfaceRules {
    elevation::ReductionConfig reduction;
    double point_sigma_m = 0.005;  ///< of one point's height
    double min_overhead_m = 0.3;   ///< what begins so far above a surface hangs over it
    double lowest_z_m = -std::numeric_limits<double>::infinity();  ///< points below are left out
    double highest_z_m = std::numeric_limits<double>::infinity();  ///< and above
};

/// The ground of a cloud; NaN where none is supported.
struct SurfaceDem {
    grid::Layer height_m;
    grid::Layer clearance_m;             ///< from the ground to what hangs over it
    std::int64_t cut_points = 0;         ///< outside the heights
    std::int64_t unsupported_cells = 0;  ///< hold points, but no surface
    std::int64_t overhung_cells = 0;
};

/// Calls the function with all points of a cloud, piece by piece; the same each time.
using EachBlock =
    std::function<Status(const std::function<Status(std::span<const Eigen::Vector3d>)>&)>;

/// Highest supported surface of each cell that does not hang. The heights of a cell's points fall
/// into groups with at least `min_overhead_m` between them; the ground is in the lowest group that
/// has a surface, and twice the fewest points for it where something hangs above
/// (what is below a floor are its mirror images), and there it is the highest surface that enough
/// points share and that is denser than an even scatter of them, and than a fifth of the surfaces
/// around: points in flight between two surfaces are scattered or few. A cell with fewer
/// points than a surface needs takes the points of its neighbours as witnesses. Neither the order
/// of the points nor the number of threads changes anything.
///
/// Reads the cloud once to count and once for each 2^25 points: memory grows with the cells and is
/// 0.5 GB more at most, or what the fullest row of cells needs.
[[nodiscard]] Result<SurfaceDem> surface_dem(const eval::DemGrid& grid,
                                             const SurfaceRules& rules,
                                             const EachBlock& each_block,
                                             Executor& executor = serial());

/// Rules from --min-height and --max-height; an error names them if they are crossed.
[[nodiscard]] Result<SurfaceRules> surface_rules(std::optional<double> lowest_z_m,
                                                 std::optional<double> highest_z_m);

/// What was left out, in words; empty where nothing was.
[[nodiscard]] std::string left_out_text(const SurfaceDem& dem);

}  // namespace surefoot::app
