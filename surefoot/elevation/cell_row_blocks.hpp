// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>

#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::elevation {

/// Splits the cells of a grid into blocks of rows; each block is one work item of an executor.
class RowBlocks {
  public:
    explicit RowBlocks(const grid::GridGeometry& geometry) : nx_(geometry.nx), ny_(geometry.ny) {}

    [[nodiscard]] int count() const noexcept { return (ny_ + kRows - 1) / kRows; }
    /// `first` is the first row of a block, `last` the row after the block's last row.
    [[nodiscard]] int first(int block) const noexcept { return block * kRows; }
    [[nodiscard]] int last(int block) const noexcept { return std::min(first(block) + kRows, ny_); }
    [[nodiscard]] static int of_row(int iy) noexcept { return iy / kRows; }
    /// Calls f(cell, index) for the cells of a block.
    template <typename F>
    void for_each_cell(int block, const F& f) const {
        auto cell = static_cast<std::size_t>(first(block)) * static_cast<std::size_t>(nx_);
        for (int iy = first(block); iy < last(block); ++iy) {
            for (int ix = 0; ix < nx_; ++ix, ++cell) f(grid::Cell{ix, iy}, cell);
        }
    }

  private:
    static constexpr int kRows = 16;

    int nx_;
    int ny_;
};

}  // namespace surefoot::elevation
