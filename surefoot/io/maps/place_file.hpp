// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "surefoot/core/result.hpp"
#include "surefoot/place_recognition/place.hpp"

/// Reads and writes remembered places. docs/reference/place_format.md defines every byte.
namespace surefoot::io {

/// A file of another major version is an error. A newer minor version may add fields to the header,
/// to keyframes and to features, which the reader skips.
inline constexpr std::uint16_t kPlaceFileMajor = 1;
inline constexpr std::uint16_t kPlaceFileMinor = 0;

/// A place and the additional contents of its file.
struct PlaceFile {
    place_recognition::Place place;
    std::uint16_t minor = kPlaceFileMinor;
};

/// Fails if `place.problem()` has a value, so that every written file can be read. The same place
/// always gives the same bytes.
[[nodiscard]] Result<std::string> format_place(const place_recognition::Place& place);
[[nodiscard]] Status write_place(const std::string& path, const place_recognition::Place& place);

/// The returned place is valid: place.problem() has no value.
[[nodiscard]] Result<PlaceFile> parse_place(std::string_view bytes, const std::string& file);
[[nodiscard]] Result<PlaceFile> read_place(const std::string& path);

}  // namespace surefoot::io
