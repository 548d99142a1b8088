// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/grid/map_region.hpp"

/// Reads and writes regions of an elevation map. docs/reference/map_format.md defines every byte.
namespace surefoot::io {

/// A file of another major version is an error. A newer minor version may add header fields and
/// layers, which the reader skips.
inline constexpr std::uint16_t kMapFileMajor = 1;
inline constexpr std::uint16_t kMapFileMinor = 0;

/// A region and the additional contents of its file.
struct MapFile {
    grid::MapRegion region;
    std::uint16_t minor = kMapFileMinor;
    std::vector<std::string> skipped_layers;  ///< layers of a newer minor version, in file order
};

/// Fails if `region.problem()` has a value, so that every written file can be read. The same region
/// always gives the same bytes.
[[nodiscard]] Result<std::string> format_map(const grid::MapRegion& region);
[[nodiscard]] Status write_map(const std::string& path, const grid::MapRegion& region);

/// The returned region is valid: region.problem() has no value.
[[nodiscard]] Result<MapFile> parse_map(std::string_view bytes, const std::string& file);
[[nodiscard]] Result<MapFile> read_map(const std::string& path);

/// FNV-1a, 64 bit. The last 8 bytes of a map file are this checksum of all bytes before them. Every
/// step is a bijection, so the checksum detects every change of a single byte.
[[nodiscard]] std::uint64_t map_checksum(std::string_view bytes) noexcept;

}  // namespace surefoot::io
