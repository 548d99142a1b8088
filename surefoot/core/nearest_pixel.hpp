// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>

namespace surefoot {

struct NearestPixel {
    int u = 0;
    int v = 0;
};

/// Returns the pixel nearest to an image position. This pixel and all pixels up to `margin` columns
/// and rows away must lie in the image; otherwise nullopt. Also nullopt for NaN and infinity.
[[nodiscard]] inline std::optional<NearestPixel> nearest_pixel(
    double u_px, double v_px, int width, int height, int margin = 0) noexcept {
    const double u = std::round(u_px);
    const double v = std::round(v_px);
    if (!(u >= margin && v >= margin && u < width - margin && v < height - margin))
        return std::nullopt;
    return NearestPixel{static_cast<int>(u), static_cast<int>(v)};  // in range, as checked
}

}  // namespace surefoot
