// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/eval/maps/maps.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::eval {

/// Returns the cells of the largest level surface of a true map, away from its edges (see
/// away_from_edges). Selects the 4 mm height band (kFloorBand_m) with the most cells, of equal
/// bands the lowest. On this surface every height difference of a live map is an error of the map.
/// On a tilted floor, the result is only a strip along a contour.
[[nodiscard]] CellMask level_floor(const grid::Layer& truth_height_m, const EvalMapsConfig& config);
inline constexpr double kFloorBand_m = 0.004;

/// Height differences between neighbouring cells: the jaggedness of a map.
struct HeightJumps {
    std::vector<float> jump_m;  ///< height of the cell with greater x or y minus the other
    std::vector<float> key;     ///< mean of the keys of the two cells
};

/// Returns all pairs of four-neighbours that are both known and in the mask (empty = all cells).
/// `key` is any value per cell for binning, for example the image column of the observation. If
/// `key` is empty, the keys are NaN. Summarise with error_figures and by_bins.
[[nodiscard]] HeightJumps height_jumps(const grid::Layer& height_m,
                                       const CellMask& mask,
                                       const grid::Layer& key);

/// Distances of the cells of a floor from one plane; NaN and 0 cells if there is no plane.
struct FloorSpread {
    double spread_m = 0.0;   ///< 1.4826 median |residual - median|: sigma of normal residuals
    double rms_m = 0.0;      ///< rms of all residuals, outliers included
    double p99_abs_m = 0.0;  ///< 99th percentile of |residual|
    double tilt_deg = 0.0;   ///< angle of the plane's normal to z
    std::int64_t count = 0;  ///< known cells in the mask
};

/// Fits the plane by total least squares, then repeats the fit without cells beyond three spreads
/// (at most 20 fits). The statistics cover all cells in the mask.
[[nodiscard]] FloorSpread floor_spread(const grid::GridGeometry& geometry,
                                       const grid::Layer& height_m,
                                       const CellMask& mask);

}  // namespace surefoot::eval
