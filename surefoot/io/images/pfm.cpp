// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/images/pfm.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <limits>

#include "surefoot/io/bytes.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

struct Header {
    int width = 0;
    int height = 0;
    std::endian order = std::endian::little;
    std::string_view pixels;
};

/// The header has "Pf", width, height and scale as words; one white space and the pixels follow.
Result<Header> parse_header(std::string_view bytes, const std::string& file) {
    if (bytes.starts_with("PF")) {
        return input_error(
            file + ": this is a colour PFM; a disparity image must have one channel ('Pf')");
    }
    if (!bytes.starts_with("Pf"))
        return input_error(
            file +
            ": not a PFM file: it must begin with 'Pf'. Convert the image to PFM with one channel");
    constexpr std::size_t kLongestHeader = 256;
    WordReader words(bytes.substr(2, kLongestHeader));
    const std::string_view width_word = words.next();
    const std::string_view height_word = words.next();
    const std::string_view scale_word = words.next();
    const auto width = parse_int64(width_word);
    const auto height = parse_int64(height_word);
    const auto scale = parse_double(scale_word);
    if (!width || !height || *width < 1 || *height < 1 || *width > 1 << 24 || *height > 1 << 24 ||
        *width * *height > kMaxImagePixels) {
        return input_error(fmt::format("{}: PFM size {} x {} is outside 1 .. {} pixels",
                                       file,
                                       quoted(width_word),
                                       quoted(height_word),
                                       kMaxImagePixels));
    }
    if (!scale || !std::isfinite(*scale) || *scale == 0.0) {
        return input_error(fmt::format(
            "{}: PFM scale {} must be a finite number other than 0", file, quoted(scale_word)));
    }
    const auto begin =
        static_cast<std::size_t>(scale_word.data() - bytes.data()) + scale_word.size();
    const std::string_view pixels = bytes.substr(std::min(begin + 1, bytes.size()));
    const auto needed = static_cast<std::size_t>(*width * *height) * sizeof(float);
    if (pixels.size() < needed) {
        return input_error(fmt::format(
            "{}: truncated PFM: {} of {} bytes of pixels", file, pixels.size(), needed));
    }
    return Header{static_cast<int>(*width),
                  static_cast<int>(*height),
                  *scale < 0.0 ? std::endian::little : std::endian::big,
                  pixels};
}

}  // namespace

Result<Image<float>> parse_pfm(std::string_view bytes, const std::string& file) {
    const Result<Header> header = parse_header(bytes, file);
    if (!header) return header.error();
    Image<float> image(header->width, header->height);
    const char* at = header->pixels.data();
    for (int v = image.height() - 1; v >= 0; --v) {
        for (int u = 0; u < image.width(); ++u, at += sizeof(float)) {
            const float value = load<float>(at, header->order);
            image.row(v)[u] =
                std::isfinite(value) ? value : std::numeric_limits<float>::quiet_NaN();
        }
    }
    return image;
}

Result<Image<float>> read_pfm(const std::string& path) {
    const Result<std::string> bytes = read_file(path, limits::kImageBytes);
    if (!bytes) return bytes.error();
    return parse_pfm(*bytes, path);
}

std::string format_pfm(const Image<float>& image) {
    std::string out = fmt::format("Pf\n{} {}\n-1\n", image.width(), image.height());
    out.reserve(out.size() + image.size() * sizeof(float));
    for (int v = image.height() - 1; v >= 0; --v) {
        for (int u = 0; u < image.width(); ++u) {
            const float value = image.row(v)[u];
            store_le(out, std::isfinite(value) ? value : std::numeric_limits<float>::infinity());
        }
    }
    return out;
}

Status write_pfm(const std::string& path, const Image<float>& image) {
    if (image.empty()) return output_error(path + ": an image without pixels cannot be written");
    return write_file(path, format_pfm(image));
}

}  // namespace surefoot::io
