// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"

/// Reads and writes little-endian float32 values (".f32"), the format of the conformance vectors.
namespace surefoot::io {

/// Fails if the bytes are not a whole number of floats, or not `count` floats (if it is given).
[[nodiscard]] Result<std::vector<float>> parse_floats(std::string_view bytes,
                                                      const std::string& file,
                                                      std::optional<std::size_t> count = {});
[[nodiscard]] Result<std::vector<float>> read_floats(const std::string& path,
                                                     std::optional<std::size_t> count = {});
[[nodiscard]] Status write_floats(const std::string& path, std::span<const float> values);

}  // namespace surefoot::io
