// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/eval/maps/maps.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::eval {

/// Cells of the largest level surface of a true map, away from its edges (as away_from_edges): of
/// the heights that are left, the 4 mm (kFloorBand_m) that hold the most cells; of equals the
/// lowest. On it every height difference of a live map is the map's own error. A tilted floor is
/// not level: only a contour strip of it would be found.
[[nodiscard]] CellMask level_floor(const grid::Layer& truth_height_m, const EvalMapsConfig& config);
inline constexpr double kFloorBand_m = 0.004;

/// Height differences between neighbouring cells, the jagged edges of a map.
struct HeightJumps {
    std::vector<float> jump_m;  ///< height of the right or upper cell minus that of the other
    std::vector<float> key;     ///< mean of the two cells' keys
};

/// All pairs of four-neighbours that are both known and both in the mask (empty = all cells).
/// `key` is any per-cell value to sort the jumps by, as the image column where the cell was seen;
/// it may be empty: the keys are NaN then. error_figures and by_bins make figures of the result.
[[nodiscard]] HeightJumps height_jumps(const grid::Layer& height_m,
                                       const CellMask& mask,
                                       const grid::Layer& key);

/// How far the cells of a floor lie from one plane; NaN and 0 cells where there is no plane.
struct FloorSpread {
    double spread_m = 0.0;   ///< 1.4826 times the median |residual - median|: one sigma if normal
    double rms_m = 0.0;      ///< of all residuals, outliers included
    double p99_abs_m = 0.0;  ///< of |residual|
    double tilt_deg = 0.0;   ///< angle of the plane's normal to z
    std::int64_t count = 0;  ///< known cells in the mask
};

/// The plane is fitted by total least squares, again and again without the cells that are off by
/// more than three spreads, until they stay the same; the figures are of all cells in the mask.
[[nodiscard]] FloorSpread floor_spread(const grid::GridGeometry& geometry,
                                       const grid::Layer& height_m,
                                       const CellMask& mask);

}  // namespace surefoot::eval
