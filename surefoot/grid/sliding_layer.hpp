// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <type_traits>
#include <vector>

#include "surefoot/core/views.hpp"
#include "surefoot/grid/moving_window.hpp"

namespace surefoot::grid {

/// A layer of a moving window: dense and in geometric order like an `Image`. Most shifts write
/// only the cells that come into view.
///
/// The rows are consecutive in a larger block of memory. Cell (ix + dx, iy + dy) lies dy rows and
/// dx cells after cell (ix, iy), so a shift only moves the start by dy * nx + dx. The shift then
/// overwrites the cells that come into view. At the end of the block (at the earliest after a
/// motion of half the window length) the cells that stay in view are copied to the middle.
template <typename T>
class SlidingLayer {
    static_assert(std::is_trivially_copyable_v<T>);

  public:
    SlidingLayer() = default;
    SlidingLayer(int nx, int ny, T value)
        : nx_(nx),
          ny_(ny),
          cells_(2 * size() + 1, value),
          begin_(static_cast<std::ptrdiff_t>(size() / 2)) {}

    [[nodiscard]] int width() const noexcept { return nx_; }
    [[nodiscard]] int height() const noexcept { return ny_; }
    [[nodiscard]] std::size_t size() const noexcept {
        return static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_);
    }
    [[nodiscard]] T* data() noexcept { return cells_.data() + begin_; }
    [[nodiscard]] const T* data() const noexcept { return cells_.data() + begin_; }
    [[nodiscard]] T* row(int iy) noexcept { return data() + static_cast<std::ptrdiff_t>(iy) * nx_; }
    [[nodiscard]] const T* row(int iy) const noexcept {
        return data() + static_cast<std::ptrdiff_t>(iy) * nx_;
    }
    [[nodiscard]] T& at(int ix, int iy) { return view().at(ix, iy); }
    [[nodiscard]] const T& at(int ix, int iy) const { return view().at(ix, iy); }
    [[nodiscard]] ImageView<T> view() noexcept { return {data(), nx_, ny_, nx_}; }
    [[nodiscard]] ImageView<const T> view() const noexcept { return {data(), nx_, ny_, nx_}; }

    /// Copies the layer for files and pictures. No conversion: a reference would bind to the copy.
    [[nodiscard]] Image<T> copy() const {
        Image<T> image(nx_, ny_);
        std::memcpy(image.data(), data(), size() * sizeof(T));
        return image;
    }

    void fill(T value) { std::fill_n(data(), size(), value); }

    /// Moves the content with the window. Cells that come into view get `value`.
    void shift(Shift shift, T value) {
        if (shift.is_zero()) return;
        if (!keeps_any(shift)) {
            fill(value);
            return;
        }
        slide(shift);
        const int kept_columns = nx_ - std::abs(shift.dx);
        const int first_new_ix = shift.dx > 0 ? kept_columns : 0;
        const int kept_rows = ny_ - std::abs(shift.dy);
        const int first_new_iy = shift.dy > 0 ? kept_rows : 0;
        std::fill_n(
            row(first_new_iy), static_cast<std::ptrdiff_t>(std::abs(shift.dy)) * nx_, value);
        const int first_kept_iy = shift.dy > 0 ? 0 : -shift.dy;
        fill_columns(row(first_kept_iy) + first_new_ix, std::abs(shift.dx), kept_rows, value);
    }
    /// Like shift, but cells that come into view keep arbitrary values. Use it for layers that
    /// write these cells before they read them. Copies cells only at the end of the memory block.
    void slide(Shift shift) {
        if (keeps_any(shift)) move_begin(static_cast<std::ptrdiff_t>(shift.dy) * nx_ + shift.dx);
    }

  private:
    [[nodiscard]] bool keeps_any(Shift shift) const noexcept {
        return std::abs(shift.dx) < nx_ && std::abs(shift.dy) < ny_;
    }
    /// Fills a strip of a few columns. Bytes are filled column by column, because one memset per
    /// row takes longer.
    void fill_columns(T* first, int columns, int rows, T value) {
        if constexpr (sizeof(T) == 1) {
            for (int ix = 0; ix < columns; ++ix, ++first) {
                T* cell = first;
                for (int iy = 0; iy < rows; ++iy, cell += nx_) *cell = value;
            }
        } else {
            for (int iy = 0; iy < rows; ++iy, first += nx_) std::fill_n(first, columns, value);
        }
    }
    void move_begin(std::ptrdiff_t by) {
        const auto cells = static_cast<std::ptrdiff_t>(size());
        const std::ptrdiff_t moved = begin_ + by;
        if (moved >= 0 && moved + cells <= static_cast<std::ptrdiff_t>(cells_.size())) {
            begin_ = moved;
            return;
        }
        // Copies only the cells that stay in view.
        const std::ptrdiff_t middle = cells / 2;
        const std::ptrdiff_t kept = cells - std::abs(by);
        if (kept > 0) {
            const std::ptrdiff_t from = by > 0 ? moved : begin_;
            const std::ptrdiff_t to = by > 0 ? middle : middle - by;
            std::memmove(cells_.data() + to,
                         cells_.data() + from,
                         static_cast<std::size_t>(kept) * sizeof(T));
        }
        begin_ = middle;
    }

    int nx_ = 0;
    int ny_ = 0;
    std::vector<T> cells_;
    std::ptrdiff_t begin_ = 0;
};

}  // namespace surefoot::grid
