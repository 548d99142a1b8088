// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::elevation {

/// Lower and upper bound of the ground in a cell whose horizontal position is uncertain. They are
/// the lowest and the highest value of any known cell within the horizontal uncertainty:
///   lower = min over |dx|, |dy| <= r of (h - k sigma),   upper = max of (h + k sigma),
///   r = ceil(k drift / resolution) of the requested cell, k = `sigmas`.
/// The fused map of the reference implementation (Fankhauser 2014) takes weighted quantiles in an
/// ellipse: 0.3 s a map at 12 mm of drift, 19 s at 100 mm (docs/evidence/benchmarks.md). A square
/// without weights is on the safe side, and its time is bounded. A table of minima over blocks of
/// 1, 2, 4, ... cells answers a square of any size with four look-ups (more at the border).
class HeightBounds {
  public:
    struct Input {
        ImageView<const float> height_m;       ///< NaN = unknown
        ImageView<const float> height_var_m2;  ///< variance of the known cells, >= 0
        ImageView<const float> horizontal_drift_m;
        double resolution_m = 0.025;
        double sigmas = 2.0;
    };
    /// Computes the bounds of all cells; NaN where the height is unknown. With a drift that is not
    /// finite, the square covers the whole map. `lower_m` and `upper_m` take the size of the map.
    /// Allocates only to grow. Every executor gives the same bytes.
    void compute(const Input& input,
                 Executor& executor,
                 grid::Layer& lower_m,
                 grid::Layer& upper_m);

  private:
    static constexpr int kBlockRows = 16;
    /// Lowest and highest value over the square with sides of 2^level cells that begins at a cell.
    struct Level {
        grid::Layer lowest_m;
        grid::Layer highest_m;
    };

    /// Returns the number r of cells to either side; at most the whole map.
    [[nodiscard]] static int reach(const Input& input, int ix, int iy);
    [[nodiscard]] int longest_reach(const Input& input) const;
    void build(const Input& input, int levels, Executor& executor);
    void build_row(int level, int iy);
    void answer_row(const Input& input, int iy, grid::Layer& lower_m, grid::Layer& upper_m) const;

    std::vector<Level> levels_;
};

}  // namespace surefoot::elevation
