// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "surefoot/core/assert.hpp"

namespace surefoot {

/// View of rows of pixels that the caller owns. Valid only during the call that receives the view.
template <typename T>
struct ImageView {
    T* data = nullptr;
    int width = 0;
    int height = 0;
    int stride = 0;  ///< elements from the start of a row to that of the next

    [[nodiscard]] T* row(int v) const noexcept {
        return data + static_cast<std::ptrdiff_t>(v) * stride;
    }
    [[nodiscard]] T& at(int u, int v) const {
        SUREFOOT_ASSERT(u >= 0 && v >= 0 && u < width && v < height);
        return row(v)[u];
    }
    [[nodiscard]] bool empty() const noexcept { return width == 0 || height == 0; }

    operator ImageView<const T>() const noexcept requires(!std::is_const_v<T>) {
        return {data, width, height, stride};
    }
};

/// Dense image, row-major, without padding. `u` counts columns to the right, `v` rows down.
template <typename T>
class Image {
  public:
    Image() = default;
    Image(int width, int height, T value = T{})
        : width_(width),
          height_(height),
          pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), value) {}

    [[nodiscard]] int width() const noexcept { return width_; }
    [[nodiscard]] int height() const noexcept { return height_; }
    [[nodiscard]] bool empty() const noexcept { return pixels_.empty(); }
    [[nodiscard]] std::size_t size() const noexcept { return pixels_.size(); }

    [[nodiscard]] T* data() noexcept { return pixels_.data(); }
    [[nodiscard]] const T* data() const noexcept { return pixels_.data(); }
    [[nodiscard]] T* row(int v) noexcept {
        return data() + static_cast<std::ptrdiff_t>(v) * width_;
    }
    [[nodiscard]] const T* row(int v) const noexcept {
        return data() + static_cast<std::ptrdiff_t>(v) * width_;
    }
    [[nodiscard]] T& at(int u, int v) {
        SUREFOOT_ASSERT(contains(u, v));
        return row(v)[u];
    }
    [[nodiscard]] const T& at(int u, int v) const {
        SUREFOOT_ASSERT(contains(u, v));
        return row(v)[u];
    }
    [[nodiscard]] bool contains(int u, int v) const noexcept {
        return u >= 0 && v >= 0 && u < width_ && v < height_;
    }

    /// Reuses the memory if the new size fits. Pixel values are unspecified afterwards.
    void resize(int width, int height) {
        width_ = width;
        height_ = height;
        pixels_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    }
    void fill(T value) { pixels_.assign(pixels_.size(), value); }

    [[nodiscard]] ImageView<T> view() noexcept { return {data(), width_, height_, width_}; }
    [[nodiscard]] ImageView<const T> view() const noexcept {
        return {data(), width_, height_, width_};
    }
    friend bool operator==(const Image&, const Image&) = default;

  private:
    int width_ = 0;
    int height_ = 0;
    std::vector<T> pixels_;
};

using GreyImage = Image<std::uint8_t>;

}  // namespace surefoot
