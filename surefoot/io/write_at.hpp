// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "surefoot/core/result.hpp"

namespace surefoot::io {

/// Returns the error for a file that cannot be written; `error` is the errno with the reason.
[[nodiscard]] Error cannot_write(const std::string& path, int error);

/// Writes all bytes to an open file at `offset`, in as many calls as needed; `path` is for errors.
[[nodiscard]] Status write_at(int descriptor,
                              std::int64_t offset,
                              std::string_view bytes,
                              const std::string& path);

}  // namespace surefoot::io
