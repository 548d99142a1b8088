// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"

/// Bare little-endian float32 values (".f32"), as the conformance vectors use them.
namespace surefoot::io {

/// Fails when the size is not whole floats, or not `count` of them where that is given.
[[nodiscard]] Result<std::vector<float>> parse_floats(std::string_view bytes,
                                                      const std::string& file,
                                                      std::optional<std::size_t> count = {});
[[nodiscard]] Result<std::vector<float>> read_floats(const std::string& path,
                                                     std::optional<std::size_t> count = {});
[[nodiscard]] Status write_floats(const std::string& path, std::span<const float> values);

}  // namespace surefoot::io
