// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "surefoot/core/result.hpp"
#include "surefoot/grid/map_snapshot.hpp"

/// Reads and writes map.snapshot, the map of the step gate. All numbers are little-endian. Order:
/// header fields of MapSnapshot, nx * ny used cells of each layer, used edges, and the checksum of
/// the snapshot with zeros in all unused cells and edges.
namespace surefoot::io {

/// Fails if the snapshot is damaged: a damaged map must not get a fresh checksum.
[[nodiscard]] Result<std::string> format_snapshot(const grid::MapSnapshot& snapshot);
[[nodiscard]] Status write_snapshot(const std::string& path, const grid::MapSnapshot& snapshot);

/// Returns an intact snapshot, allocated dynamically because it is close to a megabyte.
[[nodiscard]] Result<std::unique_ptr<grid::MapSnapshot>> parse_snapshot(std::string_view bytes,
                                                                        const std::string& file);
[[nodiscard]] Result<std::unique_ptr<grid::MapSnapshot>> read_snapshot(const std::string& path);

}  // namespace surefoot::io
