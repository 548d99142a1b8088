// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::traversability {

/// Half-open rectangle of cells: columns [ix0, ix0 + nx), rows [iy0, iy0 + ny).
struct CellRect {
    int ix0 = 0;
    int iy0 = 0;
    int nx = 0;
    int ny = 0;

    [[nodiscard]] bool empty() const noexcept { return nx <= 0 || ny <= 0; }
    /// Returns the rectangle, enlarged by `cells` on every side.
    [[nodiscard]] CellRect grown(int cells) const noexcept {
        return {ix0 - cells, iy0 - cells, nx + 2 * cells, ny + 2 * cells};
    }
    /// Returns the part within a grid of that size.
    [[nodiscard]] CellRect clipped(int grid_nx, int grid_ny) const noexcept;
    friend bool operator==(const CellRect&, const CellRect&) = default;
};

/// Copy of a rectangle of a layer with unknown cells all around it, so that loops over a disc need
/// no test of the map border. NaN is the only value for unknown.
class PaddedLayer {
  public:
    /// Extra cells to the right of the margin that SIMD loads may read.
    static constexpr int kSlack = 32;

    /// Makes room for the cells of `rect`, which the caller fills, with a margin of `margin`
    /// unknown cells on every side. Allocates only to grow.
    void reset(const CellRect& rect, int margin);
    /// Copies the cells of `rect` (within the layer and the padding). Values that are not finite
    /// become NaN.
    void load(ImageView<const float> source, const CellRect& rect);

    [[nodiscard]] int stride() const noexcept { return cells_.width(); }
    /// Returns the address of the map's cell (ix, iy), which may lie in the margin.
    [[nodiscard]] float* cell(int ix, int iy) noexcept {
        return cells_.row(iy - iy0_) + (ix - ix0_);
    }
    [[nodiscard]] const float* cell(int ix, int iy) const noexcept {
        return cells_.row(iy - iy0_) + (ix - ix0_);
    }

  private:
    int ix0_ = 0;  ///< column of the first stored cell
    int iy0_ = 0;
    grid::Layer cells_;
};

/// A cell of a disc, relative to its centre.
struct DiscCell {
    std::ptrdiff_t offset = 0;  ///< offset in elements of a PaddedLayer
    double x_m = 0.0;
    double y_m = 0.0;
};

/// All cells with dx^2 + dy^2 <= (radius / resolution)^2 + 1e-6 (in cells), row by row. Adding 1e-6
/// keeps cells on the rim inside, whatever the rounding of the quotient.
struct Disc {
    int reach = 0;  ///< largest |dx| or |dy| [cells]
    std::vector<DiscCell> cells;

    /// Returns the number of cells from the centre to the rim of a disc of that radius.
    [[nodiscard]] static int reach_of(double radius_m, double resolution_m) noexcept;
    /// Returns h: the disc covers the columns -h ... h of row dy (|dy| <= reach).
    [[nodiscard]] static int half_width_of(double radius_m, double resolution_m, int dy) noexcept;
    /// Fills the disc for layers of that stride; reuses its memory.
    void build(double radius_m, double resolution_m, int stride);
};

}  // namespace surefoot::traversability
