// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "surefoot/core/views.hpp"

namespace surefoot::camera {

/// Source position of every pixel of an image: upper left neighbour (x, y), and the fractions fx
/// and fy beyond it in units of 1/32 px. Interpolates bilinearly in integers:
///   h(row) = (32 - fx) * pixel(x, row) + fx * pixel(x + 1, row)
///   value  = ((32 - fy) * h(y) + fy * h(y + 1) + 512) >> 10
/// The results equal cv::remap with INTER_LINEAR. All instruction sets and `remap_reference` give
/// the same bytes.
class RemapTable {
  public:
    static constexpr int kUnits = 32;  ///< units per pixel

    RemapTable() = default;
    /// Starts with no source for any pixel. `source_*`: size of the image to read, at least 2x2.
    RemapTable(int width, int height, int source_width, int source_height);

    /// Sets the source position of pixel (u, v). This position must lie inside the source: 0 <=
    /// x_px <= source_width - 1, and y_px likewise.
    void set(int u, int v, float x_px, float y_px);

    [[nodiscard]] int width() const noexcept { return width_; }
    [[nodiscard]] int height() const noexcept { return height_; }

    /// `source` must have the size given to the constructor. `out` gets the size of the table.
    /// Pixels without a source become 0.
    void remap(ImageView<const std::uint8_t> source, GreyImage& out) const;
    /// As `remap`, but only the `width` x `height` pixels from (u, v) on, which must lie in the
    /// table.
    void remap_part(ImageView<const std::uint8_t> source,
                    int u,
                    int v,
                    int width,
                    int height,
                    GreyImage& out) const;
    /// Remaps pixel by pixel in plain code. Defines the result; tests compare `remap` with it.
    void remap_reference(ImageView<const std::uint8_t> source, GreyImage& out) const;

    /// The table as flat rows, one entry per pixel.
    struct View {
        const std::int32_t* offset;      ///< index y * source_width + x of the upper left neighbour
        const std::uint8_t* fraction_x;  ///< 0 to 32
        const std::uint8_t* fraction_y;  ///< 0 to 32; kNoSource = no source
    };
    static constexpr std::uint8_t kNoSource = 255;

  private:
    [[nodiscard]] View view() const noexcept {
        return {offset_.data(), fraction_x_.data(), fraction_y_.data()};
    }

    int width_ = 0;
    int height_ = 0;
    int source_width_ = 0;
    int source_height_ = 0;
    std::vector<std::int32_t> offset_;
    std::vector<std::uint8_t> fraction_x_;
    std::vector<std::uint8_t> fraction_y_;
};

}  // namespace surefoot::camera
