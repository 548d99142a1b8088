// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/grid/map_region.hpp"

/// Regions of an elevation map as files: docs/reference/map_format.md has every byte.
namespace surefoot::io {

/// Files of a newer major version are not read; a newer minor one may add header fields and layers,
/// which are stepped over.
inline constexpr std::uint16_t kMapFileMajor = 1;
inline constexpr std::uint16_t kMapFileMinor = 0;

/// A region and what its file told besides.
struct MapFile {
    grid::MapRegion region;
    std::uint16_t minor = kMapFileMinor;
    std::vector<std::string> skipped_layers;  ///< of a newer minor version, in file order
};

/// Fails where `region.problem()` is not empty: what is written can be read. The same region gives
/// the same bytes.
[[nodiscard]] Result<std::string> format_map(const grid::MapRegion& region);
[[nodiscard]] Status write_map(const std::string& path, const grid::MapRegion& region);

/// The region of the result has no problem.
[[nodiscard]] Result<MapFile> parse_map(std::string_view bytes, const std::string& file);
[[nodiscard]] Result<MapFile> read_map(const std::string& path);

/// FNV-1a, 64 bit, over bytes: the last 8 bytes of a map file are that of all before. Every step is
/// a bijection, so that no change of a single byte goes unnoticed.
[[nodiscard]] std::uint64_t map_checksum(std::string_view bytes) noexcept;

}  // namespace surefoot::io
