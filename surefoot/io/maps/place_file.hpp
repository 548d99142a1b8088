// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "surefoot/core/result.hpp"
#include "surefoot/place_recognition/place.hpp"

/// Remembered places as files: docs/reference/place_format.md has every byte.
namespace surefoot::io {

/// Files of a newer major version are not read; a newer minor one may add fields to the header, to
/// keyframes and to features, which are stepped over.
inline constexpr std::uint16_t kPlaceFileMajor = 1;
inline constexpr std::uint16_t kPlaceFileMinor = 0;

/// A place and what its file told besides.
struct PlaceFile {
    place_recognition::Place place;
    std::uint16_t minor = kPlaceFileMinor;
};

/// Fails where `place.problem()` is not empty: what is written can be read. The same place gives
/// the same bytes.
[[nodiscard]] Result<std::string> format_place(const place_recognition::Place& place);
[[nodiscard]] Status write_place(const std::string& path, const place_recognition::Place& place);

/// The place of the result has no problem.
[[nodiscard]] Result<PlaceFile> parse_place(std::string_view bytes, const std::string& file);
[[nodiscard]] Result<PlaceFile> read_place(const std::string& path);

}  // namespace surefoot::io
