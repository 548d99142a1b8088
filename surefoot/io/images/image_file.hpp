// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"

/// Reads PNG, JPEG and PGM/PPM, writes PNG. Checks that a file is complete before decoding, because
/// decoders silently fill the missing part of a truncated image with grey.
namespace surefoot::io {

struct Rgb {
    std::uint8_t r = 0;
    std::uint8_t g = 0;
    std::uint8_t b = 0;
    friend bool operator==(const Rgb&, const Rgb&) = default;
};
using RgbImage = Image<Rgb>;
using DepthCodes = Image<std::uint16_t>;

/// Returns the brightness of a colour: BT.601 (0.299 R + 0.587 G + 0.114 B) in 15-bit fixed point.
[[nodiscard]] constexpr std::uint8_t grey_bt601(std::uint8_t r,
                                                std::uint8_t g,
                                                std::uint8_t b) noexcept {
    return static_cast<std::uint8_t>((9798 * r + 19235 * g + 3735 * b + 16384) >> 15);
}

/// Contents of the header of an image file.
struct ImageHeader {
    int width = 0;
    int height = 0;
    int bits = 8;      ///< bits per channel: 8 or 16; JPEG: as stored
    int channels = 1;  ///< number of stored channels, alpha included; a palette counts as 3
};

/// Largest decoded image [pixels], so that a damaged header cannot exhaust the memory.
inline constexpr std::int64_t kMaxImagePixels = std::int64_t{1} << 27;

/// Reads the header and checks the rest: PNG chunks with their checksums up to IEND, JPEG up to its
/// end marker, PGM/PPM by its size. `file` is used only in error texts.
[[nodiscard]] Result<ImageHeader> check_image(std::string_view bytes, const std::string& file);

/// Decodes an 8-bit image as grey. Colour is weighted 0.299 R + 0.587 G + 0.114 B (BT.601); alpha
/// is ignored. 16-bit images are an error: their scale is unknown.
[[nodiscard]] Result<GreyImage> parse_grey_image(std::string_view bytes, const std::string& file);
[[nodiscard]] Result<GreyImage> read_grey_image(const std::string& path);
/// Decodes an 8-bit image in colour; a grey image gets three equal channels.
[[nodiscard]] Result<RgbImage> parse_rgb_image(std::string_view bytes, const std::string& file);
[[nodiscard]] Result<RgbImage> read_rgb_image(const std::string& path);
/// Decodes a 16-bit grey image (depth camera, disparity data set). 8-bit images are an error.
[[nodiscard]] Result<DepthCodes> parse_depth_codes(std::string_view bytes, const std::string& file);
[[nodiscard]] Result<DepthCodes> read_depth_codes(const std::string& path);

[[nodiscard]] Result<std::string> format_png(const GreyImage& image);
[[nodiscard]] Result<std::string> format_png(const RgbImage& image);
[[nodiscard]] Status write_png(const std::string& path, const GreyImage& image);
[[nodiscard]] Status write_png(const std::string& path, const RgbImage& image);
// Doxygen 1.9 confuses the overloads for depth codes with those above.
/// \cond
[[nodiscard]] Result<std::string> format_png(const DepthCodes& image);
[[nodiscard]] Status write_png(const std::string& path, const DepthCodes& image);
/// \endcond

}  // namespace surefoot::io
