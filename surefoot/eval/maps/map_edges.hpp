// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/eval/maps/maps.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::eval {

/// Cells of the largest level surface of a true map, away from its edges (as away_from_edges).
/// Selects the 4 mm height band (kFloorBand_m) with the most cells; ties: the lowest. On this
/// surface every height difference of a live map is an error of the map. A tilted floor is not
/// level: the result is only a strip along a contour of it.
[[nodiscard]] CellMask level_floor(const grid::Layer& truth_height_m, const EvalMapsConfig& config);
inline constexpr double kFloorBand_m = 0.004;

/// Height differences between neighbouring cells: the jaggedness of a map.
struct HeightJumps {
    std::vector<float> jump_m;  ///< height of the right or upper cell minus that of the other
    std::vector<float> key;     ///< mean of the two cells' keys
};

/// All pairs of four-neighbours that are both known and both in the mask (empty = all cells). `key`
/// is any value per cell to bin the jumps by, for example the image column of the observation; if
/// it is empty, the keys are NaN. Use error_figures and by_bins to summarise the result.
[[nodiscard]] HeightJumps height_jumps(const grid::Layer& height_m,
                                       const CellMask& mask,
                                       const grid::Layer& key);

/// Distances of the cells of a floor from one plane; NaN and 0 cells if there is no plane.
struct FloorSpread {
    double spread_m = 0.0;   ///< 1.4826 times the median |residual - median|: one sigma if normal
    double rms_m = 0.0;      ///< rms of all residuals, outliers included
    double p99_abs_m = 0.0;  ///< 99th percentile of |residual|
    double tilt_deg = 0.0;   ///< angle of the plane's normal to z
    std::int64_t count = 0;  ///< known cells in the mask
};

/// Fits the plane by total least squares, and repeats without cells that are off by more than three
/// spreads until nothing changes. The statistics cover all cells in the mask.
[[nodiscard]] FloorSpread floor_spread(const grid::GridGeometry& geometry,
                                       const grid::Layer& height_m,
                                       const CellMask& mask);

}  // namespace surefoot::eval
