// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/images/image_file.hpp"

#include <fmt/format.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "surefoot/io/file.hpp"

namespace surefoot::io {
namespace {

/// Decodes a checked image as grey or BGR, with 8 or 16 bits as stored. Ignores stored rotation
/// hints, because a calibration belongs to the stored pixels.
Result<cv::Mat> decode(std::string_view bytes, const std::string& file) {
    // imdecode only reads, but its interface needs a mutable Mat.
    const cv::Mat encoded(
        1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data()));
    constexpr int kFlags =
        cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR | cv::IMREAD_IGNORE_ORIENTATION;
    cv::Mat image;
    try {
        image = cv::imdecode(encoded, kFlags);
    } catch (const cv::Exception&) {
        image.release();
    }
    if (image.empty() || (image.channels() != 1 && image.channels() != 3)) {
        return input_error(fmt::format(
            "{}: the image is damaged and cannot be decoded; record the image again", file));
    }
    return image;
}

Result<cv::Mat> decode_checked(std::string_view bytes, const std::string& file, int bits) {
    if (bytes.size() > (std::size_t{1} << 30)) {
        return input_error(
            fmt::format("{}: the file has {} bytes; at most 1073741824 bytes (1 GiB) are supported",
                        file,
                        bytes.size()));
    }
    const Result<ImageHeader> header = check_image(bytes, file);
    if (!header) return header.error();
    if (bits == 8 && header->bits != 8) {
        return input_error(fmt::format(
            "{}: {} bits per channel; camera images must have 8 (convert them with a known scale)",
            file,
            header->bits));
    }
    if (bits == 16 && (header->bits != 16 || header->channels != 1)) {
        return input_error(
            fmt::format("{}: {} bits in {} channels; a depth image must be 16-bit grey PNG or PGM",
                        file,
                        header->bits,
                        header->channels));
    }
    Result<cv::Mat> image = decode(bytes, file);
    if (image && (image->depth() != (bits == 8 ? CV_8U : CV_16U) || image->cols != header->width ||
                  image->rows != header->height)) {
        return input_error(fmt::format(
            "{}: damaged image: the pixels do not match the header; record it again", file));
    }
    return image;
}

template <typename Pixel>
Result<std::string> encode(const cv::Mat& image, const Image<Pixel>& original) {
    if (original.empty()) return output_error("an image without pixels cannot be written");
    std::vector<uchar> bytes;
    try {
        // Compression level 1 needs little more space for camera images and saves most of the time.
        if (cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1})) {
            return std::string(bytes.begin(), bytes.end());
        }
    } catch (const cv::Exception&) {  // reported below
    }
    return output_error(fmt::format("an image of {} x {} pixels cannot be encoded as PNG",
                                    original.width(),
                                    original.height()));
}

template <typename Pixel>
Status write_encoded(const std::string& path, const Image<Pixel>& image) {
    const Result<std::string> bytes = format_png(image);
    if (!bytes) return output_error(path + ": " + bytes.error().message);
    return write_file(path, *bytes);
}

template <typename T, typename Parser>
Result<T> read_with(const std::string& path, Parser parser) {
    const Result<std::string> bytes = read_file(path, limits::kImageBytes);
    if (!bytes) return bytes.error();
    return parser(*bytes, path);
}

}  // namespace

Result<GreyImage> parse_grey_image(std::string_view bytes, const std::string& file) {
    const Result<cv::Mat> decoded = decode_checked(bytes, file, 8);
    if (!decoded) return decoded.error();
    const cv::Mat& image = *decoded;
    GreyImage grey(image.cols, image.rows);
    for (int v = 0; v < image.rows; ++v) {
        const std::uint8_t* in = image.ptr<std::uint8_t>(v);
        std::uint8_t* out = grey.row(v);
        if (image.channels() == 1) {
            std::copy(in, in + image.cols, out);
        } else {
            for (int u = 0; u < image.cols; ++u)
                out[u] = grey_bt601(in[3 * u + 2], in[3 * u + 1], in[3 * u]);
        }
    }
    return grey;
}

Result<RgbImage> parse_rgb_image(std::string_view bytes, const std::string& file) {
    const Result<cv::Mat> decoded = decode_checked(bytes, file, 8);
    if (!decoded) return decoded.error();
    const cv::Mat& image = *decoded;
    RgbImage rgb(image.cols, image.rows);
    const bool grey = image.channels() == 1;
    for (int v = 0; v < image.rows; ++v) {
        const std::uint8_t* in = image.ptr<std::uint8_t>(v);
        Rgb* out = rgb.row(v);
        for (int u = 0; u < image.cols; ++u) {
            out[u] = grey ? Rgb{in[u], in[u], in[u]} : Rgb{in[3 * u + 2], in[3 * u + 1], in[3 * u]};
        }
    }
    return rgb;
}

Result<DepthCodes> parse_depth_codes(std::string_view bytes, const std::string& file) {
    const Result<cv::Mat> decoded = decode_checked(bytes, file, 16);
    if (!decoded) return decoded.error();
    DepthCodes codes(decoded->cols, decoded->rows);
    for (int v = 0; v < codes.height(); ++v) {
        const std::uint16_t* in = decoded->ptr<std::uint16_t>(v);
        std::copy(in, in + codes.width(), codes.row(v));
    }
    return codes;
}

Result<GreyImage> read_grey_image(const std::string& path) {
    return read_with<GreyImage>(path, parse_grey_image);
}
Result<RgbImage> read_rgb_image(const std::string& path) {
    return read_with<RgbImage>(path, parse_rgb_image);
}
Result<DepthCodes> read_depth_codes(const std::string& path) {
    return read_with<DepthCodes>(path, parse_depth_codes);
}

Result<std::string> format_png(const GreyImage& image) {
    // imencode only reads, but a Mat needs a mutable pointer. format_png for depth codes casts for
    // the same reason.
    return encode(
        cv::Mat(image.height(), image.width(), CV_8UC1, const_cast<std::uint8_t*>(image.data())),
        image);
}

Result<std::string> format_png(const DepthCodes& image) {
    return encode(
        cv::Mat(image.height(), image.width(), CV_16UC1, const_cast<std::uint16_t*>(image.data())),
        image);
}

Result<std::string> format_png(const RgbImage& image) {
    cv::Mat bgr(image.height(), image.width(), CV_8UC3);
    for (int v = 0; v < image.height(); ++v) {
        std::uint8_t* out = bgr.ptr<std::uint8_t>(v);
        for (int u = 0; u < image.width(); ++u) {
            const Rgb& pixel = image.row(v)[u];
            out[3 * u] = pixel.b;
            out[3 * u + 1] = pixel.g;
            out[3 * u + 2] = pixel.r;
        }
    }
    return encode(bgr, image);
}

Status write_png(const std::string& path, const GreyImage& image) {
    return write_encoded(path, image);
}
Status write_png(const std::string& path, const RgbImage& image) {
    return write_encoded(path, image);
}
Status write_png(const std::string& path, const DepthCodes& image) {
    return write_encoded(path, image);
}

}  // namespace surefoot::io
