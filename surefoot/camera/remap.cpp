// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/remap.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/camera/remap_simd.hpp"

namespace surefoot::camera {
namespace {

/// Lower neighbour and fraction of a position along one axis. The last pixel counts as fraction 1
/// from the pixel before it, so that both neighbours always exist.
struct Place {
    int pixel;
    int fraction;
};

Place place_of(float position_px, int size) {
    // in range: set() asserts that the position lies in the image
    const int units = static_cast<int>(std::lrint(position_px * RemapTable::kUnits));
    const int pixel = std::min(units / RemapTable::kUnits, size - 2);
    return {pixel, units - pixel * RemapTable::kUnits};
}

}  // namespace

RemapTable::RemapTable(int width, int height, int source_width, int source_height)
    : width_(width), height_(height), source_width_(source_width), source_height_(source_height) {
    SUREFOOT_ASSERT(width >= 0 && height >= 0 && source_width >= 2 && source_height >= 2);
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    offset_.assign(pixels, 0);
    fraction_x_.assign(pixels, 0);
    fraction_y_.assign(pixels, kNoSource);
}

void RemapTable::set(int u, int v, float x_px, float y_px) {
    SUREFOOT_ASSERT(u >= 0 && v >= 0 && u < width_ && v < height_);
    SUREFOOT_ASSERT(x_px >= 0.0F && x_px <= static_cast<float>(source_width_ - 1));
    SUREFOOT_ASSERT(y_px >= 0.0F && y_px <= static_cast<float>(source_height_ - 1));
    const Place x = place_of(x_px, source_width_);
    const Place y = place_of(y_px, source_height_);
    const auto i = static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) +
                   static_cast<std::size_t>(u);
    offset_[i] = y.pixel * source_width_ + x.pixel;
    fraction_x_[i] = static_cast<std::uint8_t>(x.fraction);
    fraction_y_[i] = static_cast<std::uint8_t>(y.fraction);
}

void RemapTable::remap(ImageView<const std::uint8_t> source, GreyImage& out) const {
    SUREFOOT_ASSERT(source.width == source_width_ && source.height == source_height_ &&
                    source.stride == source_width_);
    out.resize(width_, height_);
    remap_pixels(view(), source.data, source.stride, out.data(), out.size());
}

void RemapTable::remap_part(ImageView<const std::uint8_t> source,
                            int u,
                            int v,
                            int width,
                            int height,
                            GreyImage& out) const {
    SUREFOOT_ASSERT(source.width == source_width_ && source.height == source_height_ &&
                    source.stride == source_width_);
    SUREFOOT_ASSERT(u >= 0 && v >= 0 && width >= 0 && height >= 0 && u + width <= width_ &&
                    v + height <= height_);
    out.resize(width, height);
    const View whole = view();
    for (int row = 0; row < height; ++row) {
        const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(v + row) * width_ + u;
        remap_pixels({whole.offset + first, whole.fraction_x + first, whole.fraction_y + first},
                     source.data,
                     source.stride,
                     out.row(row),
                     static_cast<std::size_t>(width));
    }
}

void RemapTable::remap_reference(ImageView<const std::uint8_t> source, GreyImage& out) const {
    SUREFOOT_ASSERT(source.width == source_width_ && source.height == source_height_ &&
                    source.stride == source_width_);
    out.resize(width_, height_);
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (fraction_y_[i] == kNoSource) {
            out.data()[i] = 0;
            continue;
        }
        const std::uint8_t* upper = source.data + offset_[i];
        const std::uint8_t* lower = upper + source.stride;
        const int right = fraction_x_[i];
        const int down = fraction_y_[i];
        const int h_upper = (kUnits - right) * upper[0] + right * upper[1];
        const int h_lower = (kUnits - right) * lower[0] + right * lower[1];
        out.data()[i] = static_cast<std::uint8_t>(
            ((kUnits - down) * h_upper + down * h_lower + kUnits * kUnits / 2) / (kUnits * kUnits));
    }
}

}  // namespace surefoot::camera
