// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/core/result.hpp"
#include "surefoot/io/maps/dem_file.hpp"

namespace surefoot::app {

/// The PNG of a verb that takes --scale and --height; a usage error where one of them is missing.
[[nodiscard]] Result<io::Dem> read_height_image(const std::string& file,
                                                double scale_m_per_px,
                                                double height_m);

}  // namespace surefoot::app
