// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/disc.hpp"
#include "surefoot/traversability/disc_runs.hpp"
#include "surefoot/traversability/traversability_config.hpp"

/// Normals, slope and roughness over a block of rows. Compiled for every instruction set and
/// selected at run time; all give the same bytes. normals.hpp, slope.hpp and roughness.hpp have the
/// plain version of the formulas.
namespace surefoot::traversability::rows {

/// Columns that are processed at a time: few enough to keep the runs of a disc's rows in the L1
/// cache.
inline constexpr int kStrip = 32;

/// Sums over the known cells of runs of one half width around kStrip neighbouring columns; x in
/// cells from the centre of the run, z in metres. z^2 has two parts, see surface_rows.cpp.
struct alignas(64) RunSums {
    double z[kStrip];
    double xz[kStrip];
    double zz_high[kStrip];
    double zz_low[kStrip];
    float n[kStrip];
    float x[kStrip];
    float xx[kStrip];
};

/// Data shared by all blocks.
struct Surface {
    const PaddedLayer& height_m;
    double resolution_m;
    const RunsOfDiscs& widths;  ///< run widths of both discs
    const DiscRuns& normals;
    const DiscRuns& roughness;
    const Disc& plain_normals;  ///< used for cells whose plane is poorly determined
    TraversabilityConfig::Slope slope_config;
    TraversabilityConfig::Roughness roughness_config;
};

struct SurfaceLayers {
    grid::Layer& normal_x;
    grid::Layer& normal_y;
    grid::Layer& normal_z;
    grid::Layer& slope;
    grid::Layer& roughness;
};

/// `ring` holds RunsOfDiscs::kept_runs() elements. Before rounding to float, the normals agree with
/// the plain normals to 1e-9 rad; slopes agree to 1e-6 rad, roughness to 1e-6 of the rating.
void rate_surface(const Surface& surface,
                  const CellRect& rect,
                  RunSums* ring,
                  const SurfaceLayers& out);

}  // namespace surefoot::traversability::rows
