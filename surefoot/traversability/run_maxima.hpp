// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace surefoot::traversability {

/// Largest values in runs of cells along the rows of a map, for runs shorter than 128 cells: two
/// overlapping runs of 1, 2, 4 ... 64 cells cover any run. Cells outside of the map are -infinity.
class RunMaxima {
  public:
    static constexpr int kMargin = 64;  ///< columns beside the map that queries may cover

    /// Makes room for a map whose rows the caller fills; allocates only to grow.
    void reset(int nx, int ny) {
        nx_ = nx;
        stride_ = nx + 2 * kMargin;
        level_size_ = static_cast<std::size_t>(stride_) * static_cast<std::size_t>(ny);
        values_.resize(kLevels * level_size_);
    }
    /// Returns the `nx` values of a row; write them before the row is built.
    [[nodiscard]] float* row(int iy) noexcept { return level(0, iy) + kMargin; }
    void build(int iy) noexcept {
        constexpr float kNothing = -std::numeric_limits<float>::infinity();
        float* values = level(0, iy);
        std::fill_n(values, kMargin, kNothing);
        std::fill_n(values + kMargin + nx_, kMargin, kNothing);
        for (std::size_t l = 1; l < kLevels; ++l) {
            const float* half = level(l - 1, iy);
            float* whole = level(l, iy);
            const int apart = 1 << (l - 1);
            const int columns = stride_ - apart;
            for (int x = 0; x < columns; ++x) {
                whole[x] = half[x] < half[x + apart] ? half[x + apart] : half[x];
            }
            std::copy_n(half + columns, apart, whole + columns);
        }
    }
    /// Sets best[ix] to the largest of itself and the cells ix + first ... ix + last of the row;
    /// -kMargin < first <= last < kMargin.
    void take(int iy, int first, int last, float* best) const noexcept {
        const int cells = last - first + 1;
        std::size_t l = 0;
        while (2 << l <= cells) ++l;
        const float* left = level(l, iy) + kMargin + first;
        const float* right = left + (cells - (1 << l));
        for (int ix = 0; ix < nx_; ++ix) {
            const float here = left[ix] < right[ix] ? right[ix] : left[ix];
            best[ix] = best[ix] < here ? here : best[ix];
        }
    }
    /// Returns the largest of the cells ix + first ... ix + last of the row; limits as for `take`.
    [[nodiscard]] float largest(int iy, int ix, int first, int last) const noexcept {
        const int cells = last - first + 1;
        std::size_t l = 0;
        while (2 << l <= cells) ++l;
        const float* left = level(l, iy) + kMargin + ix + first;
        const float right = left[cells - (1 << l)];
        return *left < right ? right : *left;
    }

  private:
    static constexpr std::size_t kLevels = 7;

    [[nodiscard]] float* level(std::size_t l, int iy) noexcept {
        return values_.data() + l * level_size_ +
               static_cast<std::size_t>(iy) * static_cast<std::size_t>(stride_);
    }
    [[nodiscard]] const float* level(std::size_t l, int iy) const noexcept {
        return values_.data() + l * level_size_ +
               static_cast<std::size_t>(iy) * static_cast<std::size_t>(stride_);
    }

    int nx_ = 0;
    int stride_ = 0;
    std::size_t level_size_ = 0;
    std::vector<float> values_;
};

}  // namespace surefoot::traversability
