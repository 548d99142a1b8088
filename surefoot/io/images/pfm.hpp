// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"

/// PFM images with one float channel ("Pf"), Middlebury's format of disparities: rows from bottom
/// to top. An unknown disparity is +inf in the file and NaN in memory.
namespace surefoot::io {

/// Reads either byte order. Values that are not finite become NaN.
[[nodiscard]] Result<Image<float>> parse_pfm(std::string_view bytes, const std::string& file);
[[nodiscard]] Result<Image<float>> read_pfm(const std::string& path);
/// Writes little-endian (scale -1).
[[nodiscard]] std::string format_pfm(const Image<float>& image);
[[nodiscard]] Status write_pfm(const std::string& path, const Image<float>& image);

}  // namespace surefoot::io
