// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::elevation {

/// How the points of one frame that fall into one cell become one measurement.
struct ReductionConfig {
    int min_points = 3;              ///< fewer points on one surface are no measurement
    double upper_share = 0.1;        ///< share of the cell's points that the upper surface needs
    double window_sigma = 2.5;       ///< points this close to a surface belong to it ...
    double surface_relief_m = 0.01;  ///< ... plus this: relief of the ground within a cell
    /// Errors of a semi-global matcher are shared over 30-50 px, more than a cell covers: until it
    /// is measured otherwise, a cell and frame hold one independent error.
    double points_per_independent = 30.0;
    double max_independent = 1.0;
    double systematic_sigma_m = 0.002;  ///< calibration and lattice errors, in every measurement

    void describe(ConfigVisitor& visitor);
};

/// A measured point in odom axes; x and y count from the corner of the grid, so that floats suffice
/// anywhere in the world. z is the height in odom.
struct GridPoint {
    float x_m = 0.0F;
    float y_m = 0.0F;
    float z_m = 0.0F;
    float var_m2 = 0.0F;  ///< of the height
};

struct HeightSample {
    float z_m = 0.0F;
    float var_m2 = 0.0F;
};

/// What one frame says about one cell.
struct CellMeasurement {
    float z_m = 0.0F;  ///< of the highest surface that enough points share
    float var_m2 = 0.0F;
    float highest_m = 0.0F;  ///< robust extremes of all points in the cell
    float lowest_m = 0.0F;
    int points = 0;  ///< on that surface
};

/// Highest surface among the samples: starts at an upper quantile of the heights, so that single
/// outliers above do not count, and climbs to the centre of the points around it (mean shift). If
/// too few points share that height, tries the next lower one. Its variance is the larger of the
/// mean variance and the scatter of the points, over the number of independent errors, plus the
/// systematic part. Reorders the samples. Nothing when no surface has enough points.
[[nodiscard]] std::optional<CellMeasurement> reduce_cell(const ReductionConfig& config,
                                                         std::span<HeightSample> samples);

/// Groups points by cell (counting sort; no allocation once the buffers have grown).
class CellGroups {
  public:
    /// Points outside of the grid are left out and counted in the result.
    std::int64_t assign(std::span<const GridPoint> points, const grid::GridGeometry& geometry);
    /// Samples of a cell by index iy * nx + ix, in the order of the points.
    [[nodiscard]] std::span<HeightSample> samples(std::size_t cell) {
        return {samples_.data() + begin_[cell], begin_[cell + 1] - begin_[cell]};
    }

  private:
    std::vector<std::uint32_t> begin_;    ///< first sample of each cell
    std::vector<std::uint32_t> cell_of_;  ///< per point
    std::vector<HeightSample> samples_;
};

}  // namespace surefoot::elevation
