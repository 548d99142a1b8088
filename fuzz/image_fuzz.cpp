// SPDX-License-Identifier: Apache-2.0
// Images and camera streams from any bytes: each gives an image of the size in its header, or an
// error with a message. SUREFOOT_FUZZ_READER names the function under test.
#include <sys/mman.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "fuzz/must.hpp"
#include "surefoot/io/bytes.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/io/live_camera/fake_video_device.hpp"
#include "surefoot/io/live_camera/live_camera.hpp"
#include "surefoot/io/maps/dem_file.hpp"
#include "surefoot/io/recordings/mjpeg_source.hpp"

namespace {

using namespace surefoot;

/// Larger images only cost time; tests of io check the size limit.
constexpr std::int64_t kMostPixels = 1 << 22;
constexpr int kMostFrames = 64;
constexpr int kWidth = 16;  ///< width of the left or right image
constexpr int kHeight = 8;

template <typename Image>
void must_agree(const Result<Image>& image, const io::ImageHeader& header) {
    must_explain(image);
    if (image) must(image->width() == header.width && image->height() == header.height);
}

void read_image(std::string_view bytes) {
    const Result<io::ImageHeader> header = io::check_image(bytes, "f");
    must_explain(header);
    if (!header || std::int64_t{header->width} * header->height > kMostPixels) return;
    must_agree(io::parse_grey_image(bytes, "f"), *header);
    must_agree(io::parse_rgb_image(bytes, "f"), *header);
    must_agree(io::parse_depth_codes(bytes, "f"), *header);
}

[[maybe_unused]] void fuzz_image(std::string_view bytes) {
    read_image(bytes);
}

/// Heights from an image: one per pixel, each of them possible.
[[maybe_unused]] void fuzz_dem_image(std::string_view bytes) {
    const Result<io::ImageHeader> header = io::check_image(bytes, "f");
    if (header && std::int64_t{header->width} * header->height > kMostPixels) return;
    constexpr double kScale_m = 0.05;
    constexpr double kFullHeight_m = 2.0;
    const auto dem = io::parse_dem_image(bytes, "f", kScale_m, kFullHeight_m);
    must_explain(dem);
    if (!dem) return;
    must(header.ok() && dem->values.width() == header->width &&
         dem->values.height() == header->height);
    for (std::size_t i = 0; i < dem->values.size(); ++i) {
        const auto height_m = static_cast<double>(dem->values.data()[i]);
        must(std::isnan(height_m) || (height_m >= 0.0 && height_m <= kFullHeight_m * 1.000001));
    }
}

std::uint32_t crc32(std::string_view bytes) {
    std::uint32_t crc = 0xffffffffU;
    for (const char byte : bytes) {
        crc ^= static_cast<std::uint8_t>(byte);
        for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1U) != 0 ? 0xedb88320U : 0U);
    }
    return ~crc;
}

/// Gives damaged chunks correct checksums, so that the damage reaches the decoder (W3C PNG, 5.3).
[[maybe_unused]] void fuzz_png(std::string_view bytes) {
    std::string png(bytes);
    for (std::size_t at = 8; at + 12 <= png.size();) {
        const auto length = io::load<std::uint32_t>(png.data() + at, std::endian::big);
        if (length > png.size() - at - 12) break;
        const std::uint32_t crc = crc32(std::string_view(png).substr(at + 4, 4U + length));
        for (std::size_t i = 0; i < 4; ++i)
            png[at + 8 + length + i] = static_cast<char>(crc >> (24 - 8 * i));
        at += 12U + length;
    }
    read_image(png);
}

camera::StereoRig small_rig() {
    camera::StereoRig rig;
    rig.left = {camera::PinholeRadTan{.fx_px = 15, .fy_px = 15, .cx_px = 7.5, .cy_px = 3.5},
                kWidth,
                kHeight};
    rig.right = rig.left;
    rig.T_left_right.translation_m.x() = 0.12;
    return rig;
}

/// Reads frames to the end. A source must end, even after errors.
void drain(camera::FrameSource& source, bool ends_at_an_error) {
    for (int i = 0; i < kMostFrames; ++i) {
        const auto frame = source.next();
        must_explain(frame);
        if (frame ? !frame->has_value() : ends_at_an_error) return;
        if (!frame) continue;
        must(frame->value().left.width() == kWidth && frame->value().right.height() == kHeight);
    }
}

[[maybe_unused]] void fuzz_mjpeg(std::string_view bytes) {
    static const int file = ::memfd_create("mjpeg", 0);
    static const std::string path = "/proc/self/fd/" + std::to_string(file);
    must(::ftruncate(file, 0) == 0);
    must(::pwrite(file, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()));
    auto source = io::open_mjpeg(path, small_rig(), 15.0);
    must_explain(source);
    if (source) drain(**source, false);
}

/// Builds a script of camera events and buffers. Each step: event (1 byte), flags (1 byte),
/// increments of stamp and counter (1 byte each), length (2 bytes), then that many data bytes.
[[maybe_unused]] void fuzz_live_camera(std::string_view bytes) {
    io::testing::FakeCamera camera;
    camera.width = 2 * kWidth;
    camera.height = kHeight;
    camera.bytes_per_line = 4 * kWidth;
    const auto take = [&]() -> std::uint8_t {
        if (bytes.empty()) return 0;
        const auto value = static_cast<std::uint8_t>(bytes.front());
        bytes.remove_prefix(1);
        return value;
    };
    if ((take() & 1U) != 0) camera.fourcc = V4L2_PIX_FMT_MJPEG;
    std::int64_t time_us = 1'000'000;
    std::uint32_t sequence = 0;
    while (!bytes.empty() && camera.script.size() < kMostFrames) {
        io::testing::FakeEvent event;
        event.kind = static_cast<io::testing::FakeEvent::Kind>(take() % 4);
        const std::uint8_t flags = take();
        if ((flags & 1U) != 0) event.flags |= V4L2_BUF_FLAG_ERROR;
        if ((flags & 2U) != 0) event.flags = V4L2_BUF_FLAG_TIMESTAMP_COPY;
        time_us += 400 * (take() - 16);
        sequence += take();
        event.time_us = time_us;
        event.sequence = sequence;
        const std::size_t length = std::size_t{take()} << 8 | take();
        event.bytes = bytes.substr(0, length);
        bytes.remove_prefix(event.bytes.size());
        camera.script.push_back(std::move(event));
    }
    io::CameraConfig config;
    config.timeout_s = 0.3;
    config.reconnect_s = 1.0;
    config.max_damaged = 3;
    auto live = io::LiveCamera::open(std::make_unique<io::testing::FakeVideoDevice>(camera),
                                     {"/dev/fake", {}, {}, {}},
                                     small_rig(),
                                     config);
    must_explain(live);
    if (live) drain(**live, true);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    SUREFOOT_FUZZ_READER({reinterpret_cast<const char*>(data), size});
    return 0;
}
