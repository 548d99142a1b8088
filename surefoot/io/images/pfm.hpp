// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"

/// PFM images of one float channel ("Pf"), as Middlebury stores disparities: rows from bottom to
/// top. In the file unknown is +inf; in memory it is NaN.
namespace surefoot::io {

/// Either byte order. Everything that is not finite becomes NaN.
[[nodiscard]] Result<Image<float>> parse_pfm(std::string_view bytes, const std::string& file);
[[nodiscard]] Result<Image<float>> read_pfm(const std::string& path);
/// Little-endian (scale -1).
[[nodiscard]] std::string format_pfm(const Image<float>& image);
[[nodiscard]] Status write_pfm(const std::string& path, const Image<float>& image);

}  // namespace surefoot::io
