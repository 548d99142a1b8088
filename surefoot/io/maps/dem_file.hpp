// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/grid/grid_geometry.hpp"

/// Reads grids with a value per cell: ESRI ASCII, or grey images (grey is the height).
namespace surefoot::io {

/// A layer with its position; NaN = unknown.
struct Dem {
    grid::GridGeometry geometry;
    grid::Layer values;
    std::vector<std::string> notes;  ///< sentences about cells that the height reader made unknown
};

/// Reads an ESRI ASCII grid: ncols nrows xllcorner|xllcenter yllcorner|yllcenter, cellsize or equal
/// dx and dy, [NODATA_value], then rows from the largest y down. Unknown cells: NODATA within float
/// precision, nan, null, and every magnitude of at least 1e30, because writers print the lowest
/// float (-3.4e38) with different digits. Heights need parse_height_grid.
[[nodiscard]] Result<Dem> parse_esri_grid(std::string_view text, const std::string& file);
[[nodiscard]] Result<Dem> read_esri_grid(const std::string& path);
/// Reads heights and makes impossible heights unknown (surefoot/io/maps/height_rules.hpp).
[[nodiscard]] Result<Dem> parse_height_grid(std::string_view text, const std::string& file);
[[nodiscard]] Result<Dem> read_height_grid(const std::string& path);
/// Formats 9 significant digits per value: the same float is read back, except near -9999 (NODATA).
[[nodiscard]] std::string format_esri_grid(const grid::GridGeometry& geometry,
                                           const grid::Layer& values);
[[nodiscard]] Status write_esri_grid(const std::string& path,
                                     const grid::GridGeometry& geometry,
                                     const grid::Layer& values);

/// Reads a height image: grey 255 (or 65535) means `full_height_m`, grey 0 means 0 m. A pixel is a
/// cell of side `scale_m`; lower left corner at (0, 0), top row at largest y. Impossible heights
/// are unknown (surefoot/io/maps/height_rules.hpp); a full height beyond kMaxHeight_m is an error.
[[nodiscard]] Result<Dem> parse_dem_image(std::string_view bytes,
                                          const std::string& file,
                                          double scale_m,
                                          double full_height_m);
[[nodiscard]] Result<Dem> read_dem_image(const std::string& path,
                                         double scale_m,
                                         double full_height_m);

}  // namespace surefoot::io
