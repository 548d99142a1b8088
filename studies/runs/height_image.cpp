// SPDX-License-Identifier: Apache-2.0
#include "studies/runs/height_image.hpp"

#include <fmt/format.h>

namespace surefoot::app {

Result<io::Dem> read_height_image(const std::string& file, double scale_m_per_px, double height_m) {
    if (scale_m_per_px <= 0.0 || height_m <= 0.0) {
        return usage_error(
            fmt::format("{}: a height image needs --scale (side of a pixel, in m) and --height "
                        "(height of a white pixel, in m), both above 0",
                        file));
    }
    return io::read_dem_image(file, scale_m_per_px, height_m);
}

}  // namespace surefoot::app
