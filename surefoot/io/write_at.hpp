// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "surefoot/core/result.hpp"

namespace surefoot::io {

/// The system's reason (errno) why a file cannot be written.
[[nodiscard]] Error cannot_write(const std::string& path, int error);

/// All bytes into an open file from `offset` on, whatever it took so far; `path` is for the error.
[[nodiscard]] Status write_at(int descriptor,
                              std::int64_t offset,
                              std::string_view bytes,
                              const std::string& path);

}  // namespace surefoot::io
