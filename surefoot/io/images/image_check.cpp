// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <bit>
#include <cctype>

#include "surefoot/io/bytes.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/io/images/jpeg_scan.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

constexpr std::string_view kPngSignature("\x89PNG\r\n\x1a\n", 8);

Error damaged(const std::string& file, std::string_view what) {
    return input_error(fmt::format("{}: {}; copy or record this image again", file, what));
}

/// Computes the CRC-32 of PNG (ISO 3309) with a byte table, which is fast enough for images.
std::uint32_t crc32(std::string_view bytes) noexcept {
    static const std::array<std::uint32_t, 256> table = [] {
        std::array<std::uint32_t, 256> values{};
        for (std::uint32_t n = 0; n < 256; ++n) {
            std::uint32_t c = n;
            for (int bit = 0; bit < 8; ++bit) c = (c >> 1) ^ ((c & 1U) != 0 ? 0xedb88320U : 0U);
            values[n] = c;
        }
        return values;
    }();
    std::uint32_t crc = 0xffffffffU;
    for (const char byte : bytes) {
        crc = table[(crc ^ static_cast<std::uint8_t>(byte)) & 0xffU] ^ (crc >> 8);
    }
    return ~crc;
}

Result<ImageHeader> checked_size(ImageHeader header, const std::string& file) {
    const std::int64_t pixels = std::int64_t{header.width} * header.height;
    if (header.width <= 0 || header.height <= 0 || pixels > kMaxImagePixels) {
        return input_error(
            fmt::format("{}: image size {} x {} px is not allowed: at least 1 x 1 px and at most "
                        "{} pixels in all",
                        file,
                        header.width,
                        header.height,
                        kMaxImagePixels));
    }
    return header;
}

Result<ImageHeader> parse_ihdr(std::string_view data, const std::string& file) {
    if (data.size() != 13) return damaged(file, "the PNG header has the wrong length");
    const auto width = load<std::uint32_t>(data.data(), std::endian::big);
    const auto height = load<std::uint32_t>(data.data() + 4, std::endian::big);
    if (width > 1U << 24 || height > 1U << 24) {
        return input_error(
            fmt::format("{}: image size {} x {} exceeds 2^24 px on a side", file, width, height));
    }
    static constexpr int kChannels[] = {1, 0, 3, 3, 2, 0, 4};
    const int colour = static_cast<std::uint8_t>(data[9]);
    ImageHeader header;
    header.width = static_cast<int>(width);
    header.height = static_cast<int>(height);
    header.bits = data[8] == 16 ? 16 : 8;
    header.channels = colour <= 6 ? kChannels[colour] : 0;
    if (header.channels == 0) return damaged(file, "the PNG header has an unknown colour type");
    return checked_size(header, file);
}

/// Checks all chunks. A chunk has length (big-endian), type, data, and CRC of type and data.
Result<ImageHeader> check_png(std::string_view bytes, const std::string& file) {
    std::size_t at = kPngSignature.size();
    Result<ImageHeader> header = damaged(file, "the PNG has no header");
    bool has_pixels = false;
    for (bool first = true; bytes.size() - at >= 12; first = false) {
        const auto length = load<std::uint32_t>(bytes.data() + at, std::endian::big);
        if (length > bytes.size() - at - 12) break;
        const std::string_view type = bytes.substr(at + 4, 4);
        const std::string_view data = bytes.substr(at + 8, length);
        const auto crc = load<std::uint32_t>(bytes.data() + at + 8 + length, std::endian::big);
        if (crc != crc32(bytes.substr(at + 4, 4 + length))) {
            return damaged(
                file,
                fmt::format(
                    "damaged PNG: wrong checksum of the part {} at byte {}", quoted(type), at));
        }
        if (first != (type == "IHDR"))
            return damaged(file, "damaged PNG: the header must be the first part");
        if (first) header = parse_ihdr(data, file);
        if (!header) return header;
        has_pixels = has_pixels || type == "IDAT";
        if (type == "IEND") {
            return has_pixels ? header
                              : Result<ImageHeader>(damaged(file, "the PNG has no pixels"));
        }
        at += 12 + length;
    }
    return damaged(file,
                   fmt::format("truncated PNG: {} bytes, and its end is missing", bytes.size()));
}

constexpr bool is_frame_header(int marker) noexcept {  // SOF0 to SOF15, except DHT, JPG and DAC
    return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

/// Checks the JPEG segments (marker, big-endian length) up to the end marker FFD9. Skips the image
/// data after a scan header.
Result<ImageHeader> check_jpeg(std::string_view bytes, const std::string& file) {
    std::size_t at = 2;
    Result<ImageHeader> header = damaged(file, "the JPEG has no header with its size");
    while (bytes.size() - at >= 2) {
        if (bytes[at] != '\xff') return damaged(file, fmt::format("damaged JPEG at byte {}", at));
        const int marker = static_cast<std::uint8_t>(bytes[at + 1]);
        if (marker == 0xd9) return header;
        if (marker == 0xff) {  // fill byte
            ++at;
            continue;
        }
        if (bytes.size() - at < 4) break;
        const auto length = load<std::uint16_t>(bytes.data() + at + 2, std::endian::big);
        if (length < 2 || length > bytes.size() - at - 2) break;
        if (is_frame_header(marker) && length >= 8) {
            const char* data = bytes.data() + at + 4;
            ImageHeader frame;
            frame.bits = static_cast<std::uint8_t>(data[0]);
            frame.height = load<std::uint16_t>(data + 1, std::endian::big);
            frame.width = load<std::uint16_t>(data + 3, std::endian::big);
            frame.channels = static_cast<std::uint8_t>(data[5]);
            header = checked_size(frame, file);
            if (!header) return header;
        }
        at += 2U + length;
        if (marker == 0xda) at = end_of_scan(bytes, at);
    }
    return damaged(file,
                   fmt::format("truncated JPEG: {} bytes, and its end is missing", bytes.size()));
}

/// Checks binary PGM (P5) and PPM (P6): "P5 width height maxval" with comments, one space, then the
/// pixels.
Result<ImageHeader> check_pnm(std::string_view bytes, const std::string& file) {
    std::size_t at = 2;
    std::int64_t numbers[3] = {0, 0, 0};
    for (std::int64_t& number : numbers) {
        while (at < bytes.size() &&
               (std::isspace(static_cast<unsigned char>(bytes[at])) != 0 || bytes[at] == '#')) {
            at = bytes[at] == '#' ? std::min(bytes.find('\n', at), bytes.size()) : at + 1;
        }
        const std::size_t end = std::min(bytes.find_first_not_of("0123456789", at), bytes.size());
        number = parse_int64(bytes.substr(at, std::min<std::size_t>(end - at, 9))).value_or(-1);
        at = end;
    }
    if (numbers[2] < 1 || numbers[2] > 65535 || at >= bytes.size()) {
        return damaged(file, "damaged PGM/PPM header");
    }
    ImageHeader header;
    header.width = static_cast<int>(numbers[0]);
    header.height = static_cast<int>(numbers[1]);
    header.bits = numbers[2] > 255 ? 16 : 8;
    header.channels = bytes[1] == '6' ? 3 : 1;
    if (auto sized = checked_size(header, file); !sized) return sized;
    const std::uint64_t needed = static_cast<std::uint64_t>(numbers[0] * numbers[1]) *
                                 static_cast<std::uint64_t>(header.channels * header.bits / 8);
    if (bytes.size() - at - 1 < needed) {
        return damaged(
            file,
            fmt::format(
                "truncated PGM/PPM: {} of {} bytes of pixels", bytes.size() - at - 1, needed));
    }
    return header;
}

}  // namespace

Result<ImageHeader> check_image(std::string_view bytes, const std::string& file) {
    if (bytes.empty()) return damaged(file, "empty file where an image is expected");
    if (bytes.starts_with(kPngSignature)) return check_png(bytes, file);
    if (bytes.starts_with("\xff\xd8")) return check_jpeg(bytes, file);
    if (bytes.starts_with("P5") || bytes.starts_with("P6")) return check_pnm(bytes, file);
    if (kPngSignature.starts_with(bytes)) return damaged(file, "truncated PNG");
    return input_error(
        fmt::format("{}: not a PNG, JPEG or binary PGM/PPM image; convert it to PNG", file));
}

}  // namespace surefoot::io
