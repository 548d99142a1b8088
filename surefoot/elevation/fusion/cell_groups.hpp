// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::elevation {

/// A measured point in odom axes. x and y count from the corner of the grid, so floats are precise
/// enough anywhere in the world. z is the height in odom.
struct GridPoint {
    float x_m = 0.0F;
    float y_m = 0.0F;
    float z_m = 0.0F;
    float var_m2 = 0.0F;  ///< variance of the height
};

/// Heights and their cells, in blocks that threads can fill at the same time.
class CellSamples {
  public:
    /// Number of elements that a register store may write beyond the last sample of a block.
    static constexpr std::size_t kSlack = 64;

    /// Deletes all samples. Makes room for `blocks` blocks of `most` samples. Allocates to grow.
    void reset(int blocks, std::size_t most);
    [[nodiscard]] int blocks() const noexcept { return static_cast<int>(counts_.size()); }

    struct Columns {
        std::uint32_t* cell = nullptr;  ///< index of the cell, iy * nx + ix
        float* z_m = nullptr;
        float* var_m2 = nullptr;
    };
    [[nodiscard]] Columns columns(int block) noexcept;
    void set_count(int block, std::size_t count) noexcept;

    struct Block {
        std::span<const std::uint32_t> cell;
        std::span<const float> z_m;
        std::span<const float> var_m2;
    };
    [[nodiscard]] Block block(int block) const noexcept;

  private:
    std::size_t stride_ = 0;
    std::vector<std::size_t> counts_;
    std::vector<std::uint32_t> cell_;
    std::vector<float> z_m_;
    std::vector<float> var_m2_;
};

/// Converts points over a grid into samples, as one block. Skips points outside of the grid, also
/// those that are not finite, and returns their number.
std::int64_t samples_from_points(std::span<const GridPoint> points,
                                 const grid::GridGeometry& geometry,
                                 CellSamples& samples);

/// Groups samples by cell (counting sort; no allocation once the buffers have grown).
class CellGroups {
  public:
    /// Number of elements that a register load may read beyond the last sample of a cell.
    static constexpr std::size_t kSlack = 16;

    void assign(const CellSamples& samples, std::size_t cells);

    /// Samples of cell c lie at [begin()[c], begin()[c + 1]), in the order in which they came.
    [[nodiscard]] const std::uint32_t* begin() const noexcept { return begin_.data(); }
    [[nodiscard]] const float* z_m() const noexcept { return z_m_.data(); }
    [[nodiscard]] const float* var_m2() const noexcept { return var_m2_.data(); }

  private:
    std::vector<std::uint32_t> begin_;  ///< size: cells + 2
    std::vector<float> z_m_;
    std::vector<float> var_m2_;
};

}  // namespace surefoot::elevation
