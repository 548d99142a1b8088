// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace surefoot::io {

/// A cloud file whose points are rows of one size. Any sequence of these rows, after a header with
/// their number, is a file of the same format.
struct CloudRows {
    std::uint64_t first_byte = 0;
    std::uint64_t rows = 0;
    std::uint64_t row_bytes = 0;
    std::function<std::string(std::uint64_t)> head;  ///< returns the header for this number of rows
};

/// Detects the rows from the first bytes of a file of `size` bytes. Returns no value if the file is
/// damaged or its points are not such rows (text, compressed PCD, PLY vertices with lists).
[[nodiscard]] std::optional<CloudRows> ply_rows(std::string_view head, std::uint64_t size);
[[nodiscard]] std::optional<CloudRows> pcd_rows(std::string_view head, std::uint64_t size);
[[nodiscard]] std::optional<CloudRows> las_rows(std::string_view head, std::uint64_t size);

}  // namespace surefoot::io
