// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/live_camera/v4l2_device.hpp"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <system_error>
#include <utility>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

/// Limit for lists of the driver: the list of a faulty driver may never end.
constexpr std::uint32_t kMaxListed = 256;
/// Relative tolerance of the frame rate: drivers round it to a rate that the sensor supports.
constexpr double kRateTolerance = 0.02;

template <std::size_t size>
std::string text_of(const std::uint8_t (&field)[size]) {
    const auto* begin = reinterpret_cast<const char*>(field);
    return {begin, ::strnlen(begin, size)};
}

std::string fourcc_text(std::uint32_t code) {
    std::string text;
    for (int shift = 0; shift < 32; shift += 8) {
        const auto c = static_cast<char>((code >> shift) & 0x7fU);
        text += c >= ' ' && c != 0x7f ? c : '?';
    }
    return text;
}

PixelFormat format_of(std::uint32_t code) {
    if (code == V4L2_PIX_FMT_YUYV) return PixelFormat::yuyv;
    if (code == V4L2_PIX_FMT_MJPEG || code == V4L2_PIX_FMT_JPEG) return PixelFormat::mjpeg;
    return PixelFormat::other;
}

std::uint32_t code_of(const VideoMode& mode) {
    if (mode.format == PixelFormat::yuyv) return V4L2_PIX_FMT_YUYV;
    return mode.fourcc == "JPEG" ? V4L2_PIX_FMT_JPEG : V4L2_PIX_FMT_MJPEG;
}

double rate_of(const v4l2_fract& interval) {
    if (interval.numerator == 0) return 0.0;
    return static_cast<double>(interval.denominator) / static_cast<double>(interval.numerator);
}

}  // namespace

Error V4l2Device::failed(const std::string& what, int error_number) const {
    return input_error(
        fmt::format("{}: {}: {}", path_, what, std::generic_category().message(error_number)));
}

Result<V4l2Device> V4l2Device::open(VideoDevice& system, const std::string& path) {
    V4l2Device device(system, path);
    if (const int error = system.open(path); error != 0) {
        if (error == EACCES) {
            return input_error(fmt::format(
                "{}: no permission to open it; add the user to the group 'video' and log in again",
                path));
        }
        if (error == ENOTTY)
            return input_error(path +
                               ": this is not a device ('surefoot doctor' lists the cameras)");
        return device.failed("cannot be opened (surefoot doctor lists the cameras)", error);
    }
    v4l2_capability capability = {};
    if (const int error = system.request(VIDIOC_QUERYCAP, &capability); error != 0)
        return device.failed("this is not a video device (surefoot doctor lists the cameras)",
                             error);
    const std::uint32_t can = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0
                                  ? capability.device_caps
                                  : capability.capabilities;
    if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0) {
        return input_error(
            fmt::format("{}: this device delivers no video stream; a camera can have several "
                        "devices: use the first device of this camera",
                        path));
    }
    device.card_ = text_of(capability.card);
    device.driver_ = text_of(capability.driver);
    return device;
}

V4l2Device::V4l2Device(V4l2Device&& other) noexcept
    : system_(std::exchange(other.system_, nullptr)),
      path_(std::move(other.path_)),
      card_(std::move(other.card_)),
      driver_(std::move(other.driver_)),
      bytes_per_line_(other.bytes_per_line_),
      mappings_(std::move(other.mappings_)) {}

V4l2Device::~V4l2Device() {
    if (system_ == nullptr) return;
    for (const Mapping& mapping : mappings_) system_->unmap(mapping.address, mapping.length);
    system_->close();
}

std::vector<VideoMode> V4l2Device::modes() {
    std::vector<VideoMode> modes;
    for (std::uint32_t index = 0; index < kMaxListed; ++index) {
        v4l2_fmtdesc description = {};
        description.index = index;
        description.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
        if (system_->request(VIDIOC_ENUM_FMT, &description) != 0) break;
        add_sizes(description.pixelformat, modes);
    }
    return modes;
}

void V4l2Device::add_sizes(std::uint32_t fourcc, std::vector<VideoMode>& modes) {
    for (std::uint32_t index = 0; index < kMaxListed; ++index) {
        v4l2_frmsizeenum size = {};
        size.index = index;
        size.pixel_format = fourcc;
        if (system_->request(VIDIOC_ENUM_FRAMESIZES, &size) != 0) break;
        VideoMode mode;
        mode.format = format_of(fourcc);
        mode.fourcc = fourcc_text(fourcc);
        const bool discrete = size.type == V4L2_FRMSIZE_TYPE_DISCRETE;
        mode.width = static_cast<int>(discrete ? size.discrete.width : size.stepwise.max_width);
        mode.height = static_cast<int>(discrete ? size.discrete.height : size.stepwise.max_height);
        add_rates(fourcc, mode, modes);
        if (!discrete) break;  // a range of sizes gives one mode with the largest size
    }
}

void V4l2Device::add_rates(std::uint32_t fourcc,
                           const VideoMode& mode,
                           std::vector<VideoMode>& modes) {
    const std::size_t before = modes.size();
    for (std::uint32_t index = 0; index < kMaxListed; ++index) {
        v4l2_frmivalenum interval = {};
        interval.index = index;
        interval.pixel_format = fourcc;
        interval.width = static_cast<std::uint32_t>(mode.width);
        interval.height = static_cast<std::uint32_t>(mode.height);
        if (system_->request(VIDIOC_ENUM_FRAMEINTERVALS, &interval) != 0) break;
        modes.push_back(mode);
        const bool discrete = interval.type == V4L2_FRMIVAL_TYPE_DISCRETE;
        modes.back().rate_hz = rate_of(discrete ? interval.discrete : interval.stepwise.min);
        if (!discrete) break;
    }
    if (modes.size() == before) modes.push_back(mode);
}

std::optional<VideoControl> V4l2Device::control(std::uint32_t id) {
    v4l2_queryctrl query = {};
    query.id = id;
    if (system_->request(VIDIOC_QUERYCTRL, &query) != 0) return std::nullopt;
    if ((query.flags & V4L2_CTRL_FLAG_DISABLED) != 0) return std::nullopt;
    VideoControl control;
    control.id = query.id;
    control.name = text_of(query.name);
    control.min = query.minimum;
    control.max = query.maximum;
    control.step = query.step;
    constexpr std::uint32_t kNotNow =
        V4L2_CTRL_FLAG_READ_ONLY | V4L2_CTRL_FLAG_INACTIVE | V4L2_CTRL_FLAG_GRABBED;
    control.writable = (query.flags & kNotNow) == 0;
    v4l2_control value = {query.id, 0};
    const bool readable = (query.flags & V4L2_CTRL_FLAG_WRITE_ONLY) == 0;
    if (readable && system_->request(VIDIOC_G_CTRL, &value) == 0) control.value = value.value;
    return control;
}

std::vector<VideoControl> V4l2Device::controls() {
    std::vector<VideoControl> controls;
    v4l2_queryctrl query = {};
    for (std::uint32_t count = 0; count < kMaxListed; ++count) {
        query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
        if (system_->request(VIDIOC_QUERYCTRL, &query) != 0) break;
        const bool number = query.type == V4L2_CTRL_TYPE_INTEGER ||
                            query.type == V4L2_CTRL_TYPE_BOOLEAN ||
                            query.type == V4L2_CTRL_TYPE_MENU;
        if (!number) continue;
        if (auto found = control(query.id)) controls.push_back(std::move(*found));
    }
    return controls;
}

Status V4l2Device::set_control(std::uint32_t id, const std::string& name, int value) {
    const auto known = control(id);
    if (!known) {
        return usage_error(fmt::format(
            "{}: the camera has no control for {} (surefoot info v4l2:{} lists its controls)",
            path_,
            name,
            path_));
    }
    if (value < known->min || value > known->max) {
        return usage_error(fmt::format(
            "{}: {} = {} is outside {} .. {}", path_, name, value, known->min, known->max));
    }
    v4l2_control request = {id, value};
    if (const int error = system_->request(VIDIOC_S_CTRL, &request); error != 0)
        return failed(fmt::format("{} cannot be set to {}", name, value), error);
    v4l2_control now = {id, value};
    if (system_->request(VIDIOC_G_CTRL, &now) == 0 && std::abs(now.value - value) >= known->step &&
        now.value != value) {
        return input_error(
            fmt::format("{}: {} was set to {}, but the camera reports {}; choose a value that the "
                        "camera accepts",
                        path_,
                        name,
                        value,
                        now.value));
    }
    return {};
}

Status V4l2Device::set_mode(const VideoMode& mode) {
    v4l2_format format = {};
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    format.fmt.pix.width = static_cast<std::uint32_t>(mode.width);
    format.fmt.pix.height = static_cast<std::uint32_t>(mode.height);
    format.fmt.pix.pixelformat = code_of(mode);
    format.fmt.pix.field = V4L2_FIELD_NONE;
    if (const int error = system_->request(VIDIOC_S_FMT, &format); error != 0)
        return failed("the image format cannot be set", error);
    const v4l2_pix_format& got = format.fmt.pix;
    if (static_cast<int>(got.width) != mode.width || static_cast<int>(got.height) != mode.height ||
        format_of(got.pixelformat) != mode.format) {
        return input_error(
            fmt::format("{}: asked for {} x {} {}, but the camera gives {} x {} {}; run 'surefoot "
                        "info v4l2:{}' to list its modes",
                        path_,
                        mode.width,
                        mode.height,
                        mode.fourcc,
                        got.width,
                        got.height,
                        fourcc_text(got.pixelformat),
                        path_));
    }
    const std::uint32_t least = mode.format == PixelFormat::yuyv ? 2 * got.width : 0;
    bytes_per_line_ = static_cast<int>(std::max(got.bytesperline, least));
    return mode.rate_hz > 0.0 ? set_rate(mode.rate_hz) : Status{};
}

Status V4l2Device::set_rate(double rate_hz) {
    constexpr std::uint32_t kTicksPerSecond = 10'000;
    v4l2_streamparm parameters = {};
    parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    parameters.parm.capture.timeperframe = {
        saturated_integer<std::uint32_t>(std::round(kTicksPerSecond / rate_hz)), kTicksPerSecond};
    if (const int error = system_->request(VIDIOC_S_PARM, &parameters); error != 0)
        return failed(fmt::format("its rate cannot be set to {:g} Hz", rate_hz), error);
    const double got_hz = rate_of(parameters.parm.capture.timeperframe);
    if (std::abs(got_hz - rate_hz) <= kRateTolerance * rate_hz) return {};
    return input_error(
        fmt::format("{}: asked for {:g} Hz, but the camera gives {:g} Hz at this size; run "
                    "'surefoot info v4l2:{}' to list its modes",
                    path_,
                    rate_hz,
                    got_hz,
                    path_));
}

Status V4l2Device::map_buffer(std::uint32_t slot) {
    v4l2_buffer buffer = {};
    buffer.index = slot;
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    if (const int error = system_->request(VIDIOC_QUERYBUF, &buffer); error != 0)
        return failed("its buffers cannot be requested", error);
    const std::uint8_t* address = system_->map(buffer.m.offset, buffer.length);
    if (address == nullptr) return failed("its buffers cannot be mapped", ENOMEM);
    mappings_.push_back({address, buffer.length});
    if (const int error = system_->request(VIDIOC_QBUF, &buffer); error != 0)
        return failed("a buffer cannot be queued", error);
    return {};
}

Status V4l2Device::start() {
    v4l2_requestbuffers buffers = {};
    buffers.count = kBuffers;
    buffers.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffers.memory = V4L2_MEMORY_MMAP;
    if (const int error = system_->request(VIDIOC_REQBUFS, &buffers); error != 0) {
        return failed(error == EBUSY ? "is in use by another program" : "gives no buffers", error);
    }
    if (buffers.count < 2) return failed("gives fewer than two buffers", ENOMEM);
    for (std::uint32_t slot = 0; slot < buffers.count; ++slot) {
        if (Status status = map_buffer(slot); !status) return status;
    }
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (const int error = system_->request(VIDIOC_STREAMON, &type); error != 0) {
        return failed(error == ENOSPC ? "not enough USB bandwidth (choose a smaller or slower mode)"
                                      : "cannot start the video stream",
                      error);
    }
    return {};
}

Result<std::optional<VideoBuffer>> V4l2Device::dequeue(int timeout_ms) {
    if (const int error = system_->wait(timeout_ms); error != 0) {
        if (error == ETIMEDOUT || error == EINTR) return std::optional<VideoBuffer>();
        return failed("stopped delivering images", error);
    }
    v4l2_buffer raw = {};
    raw.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    raw.memory = V4L2_MEMORY_MMAP;
    if (const int error = system_->request(VIDIOC_DQBUF, &raw); error != 0) {
        if (error == EAGAIN) return std::optional<VideoBuffer>();
        return failed("stopped delivering images", error);
    }
    if (raw.index >= mappings_.size())
        return input_error(fmt::format(
            "{}: the driver returned buffer {}, which does not exist", path_, raw.index));
    VideoBuffer buffer;
    const Mapping& mapping = mappings_[raw.index];
    buffer.bytes = {mapping.address, std::min<std::size_t>(raw.bytesused, mapping.length)};
    buffer.bytes_per_line = bytes_per_line_;
    buffer.time_ns = static_cast<std::int64_t>(raw.timestamp.tv_sec) * 1'000'000'000 +
                     static_cast<std::int64_t>(raw.timestamp.tv_usec) * 1'000;
    buffer.monotonic =
        (raw.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    buffer.at_exposure_start =
        (raw.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
    buffer.sequence = raw.sequence;
    buffer.damaged = (raw.flags & V4L2_BUF_FLAG_ERROR) != 0;
    buffer.slot = raw.index;
    return std::optional<VideoBuffer>(buffer);
}

Status V4l2Device::give_back(const VideoBuffer& buffer) {
    v4l2_buffer raw = {};
    raw.index = buffer.slot;
    raw.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    raw.memory = V4L2_MEMORY_MMAP;
    if (const int error = system_->request(VIDIOC_QBUF, &raw); error != 0)
        return failed("a buffer cannot be queued", error);
    return {};
}

}  // namespace surefoot::io
