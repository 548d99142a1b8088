// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "surefoot/core/result.hpp"
#include "surefoot/grid/map_snapshot.hpp"

/// Reads and writes map.snapshot, the map of the step gate. All numbers are little-endian. Order:
/// header fields of MapSnapshot, each layer with its nx * ny used cells, and the checksum of the
/// snapshot with all unused cells set to zero.
namespace surefoot::io {

/// Fails if the snapshot is damaged: a damaged map must not get a fresh checksum.
[[nodiscard]] Result<std::string> format_snapshot(const grid::MapSnapshot& snapshot);
[[nodiscard]] Status write_snapshot(const std::string& path, const grid::MapSnapshot& snapshot);

/// Allocated dynamically, because a snapshot is close to a megabyte. The result is intact.
[[nodiscard]] Result<std::unique_ptr<grid::MapSnapshot>> parse_snapshot(std::string_view bytes,
                                                                        const std::string& file);
[[nodiscard]] Result<std::unique_ptr<grid::MapSnapshot>> read_snapshot(const std::string& path);

}  // namespace surefoot::io
