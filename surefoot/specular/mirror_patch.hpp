// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::specular {

/// Detail of a piece of floor, prepared for comparison with its own mirror image. Detail is the
/// difference of a cell from its neighbours, normalised to the same strength everywhere. Structure
/// that is constant along a row or a column (joints of tiles) is removed. A "line" is a row of
/// cells parallel to the mirror lines of the search. Memory holds one line after the other.
struct PatchDetail {
    static constexpr int kUnit = 40;    ///< about one standard deviation
    static constexpr int kBlocks = 12;  ///< number of blocks of a line; each block has its own sum

    int lines = 0;
    int line_cells = 0;
    std::vector<std::int16_t> values;  ///< 0 = unknown
    std::vector<std::int16_t> known;   ///< number of known cells in each block of each line
    double mean_square = 0.0;          ///< mean square of the known values

    void resize(int new_lines, int new_line_cells);
    [[nodiscard]] const std::int16_t* line(int i) const {
        return values.data() + static_cast<std::ptrdiff_t>(i) * line_cells;
    }
    [[nodiscard]] const std::int16_t* known_in(int i) const {
        return known.data() + static_cast<std::ptrdiff_t>(i) * kBlocks;
    }
};

/// A rectangle of the floor picture, rotated so that its rows are parallel to the mirror lines of
/// the search. Never allocates after construction.
class MirrorPatch {
  public:
    static constexpr int kLines = 256;
    static constexpr int kLineCells = 192;

    MirrorPatch();

    /// Samples the rectangle around `middle_m` (odom). Line numbers grow along (cos, sin) of
    /// `angle_rad`, cells of a line toward the left of that direction.
    void sample(const grid::GridGeometry& geometry,
                ImageView<const float> brightness,
                const Eigen::Vector2d& middle_m,
                double angle_rad);

    [[nodiscard]] const PatchDetail& fine() const noexcept { return fine_; }      ///< full detail
    [[nodiscard]] const PatchDetail& coarse() const noexcept { return coarse_; }  ///< half as fine

  private:
    void halve();

    Image<float> grey_;  ///< a row is a line
    Image<float> half_;
    Image<float> work_;
    Image<float> half_work_;
    PatchDetail fine_;
    PatchDetail coarse_;
};

/// Computes the detail of a brightness image (NaN = unknown; a row is a line). Divides the
/// Laplacian by the mean of its strengths in the tile (16 x 16 cells) and in the whole image. Then
/// limits outliers and removes the means along and across the lines. `work`: scratch, same size.
void take_detail(const Image<float>& grey, Image<float>& work, PatchDetail& out);

}  // namespace surefoot::specular
