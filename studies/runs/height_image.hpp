// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/core/result.hpp"
#include "surefoot/io/maps/dem_file.hpp"

namespace surefoot::app {

/// Reads a height map from a PNG: `scale_m_per_px` is the cell size, `height_m` the height of full
/// white. A value that is not positive (option --scale or --height not given) is a usage error.
[[nodiscard]] Result<io::Dem> read_height_image(const std::string& file,
                                                double scale_m_per_px,
                                                double height_m);

}  // namespace surefoot::app
