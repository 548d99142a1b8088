// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/live_camera/live_camera.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "surefoot/io/images/image_file.hpp"
#include "surefoot/io/recordings/recording.hpp"

namespace surefoot::io {
namespace {

/// A larger gap in the frame counter means that the counter restarted, not that frames were lost.
constexpr std::uint32_t kMaxDropped = 100'000;

Result<GreyImage> grey_of_yuyv(const VideoBuffer& buffer, const VideoMode& mode) {
    const auto stride = static_cast<std::size_t>(buffer.bytes_per_line);
    const auto height = static_cast<std::size_t>(mode.height);
    // The last line may have no padding after its last pixel.
    const std::size_t needed = stride * (height - 1) + 2 * static_cast<std::size_t>(mode.width);
    if (buffer.bytes.size() < needed)
        return input_error(
            fmt::format("the image has only {} of {} bytes", buffer.bytes.size(), needed));
    GreyImage image(mode.width, mode.height);
    for (int v = 0; v < mode.height; ++v) {
        const std::uint8_t* in = buffer.bytes.data() + stride * static_cast<std::size_t>(v);
        std::uint8_t* out = image.row(v);
        for (int u = 0; u < mode.width; ++u) out[u] = in[2 * u];  // Y0 U Y1 V
    }
    return image;
}

}  // namespace

LiveCamera::LiveCamera(std::unique_ptr<VideoDevice> system,
                       const LiveAddress& address,
                       const camera::StereoRig& rig,
                       const CameraConfig& config,
                       std::function<bool()> stop)
    : system_(std::move(system)),
      address_(address),
      rig_(rig),
      config_(config),
      stop_(std::move(stop)) {
    info_.kind = "live";
    info_.steady_stamps = true;
    info_.path = "v4l2:" + address.device;
}

Result<std::unique_ptr<LiveCamera>> LiveCamera::open(std::unique_ptr<VideoDevice> system,
                                                     const LiveAddress& address,
                                                     const camera::StereoRig& rig,
                                                     const CameraConfig& config,
                                                     std::function<bool()> stop) {
    if (const auto problem = config.problem()) return usage_error(*problem);
    const int width = address.width.value_or(2 * rig.left.width);
    const int height = address.height.value_or(rig.left.height);
    if (!rig.right || width != 2 * rig.left.width || height != rig.left.height) {
        return usage_error(fmt::format(
            "v4l2:{}: {} x {} px with both cameras, but the rig has {} of {} x {} px; give "
            "the rig of this resolution with --rig",
            address.device,
            width,
            height,
            rig.right ? "two cameras" : "one camera",
            rig.left.width,
            rig.left.height));
    }
    std::unique_ptr<LiveCamera> camera(
        new LiveCamera(std::move(system), address, rig, config, std::move(stop)));
    if (Status status = camera->connect(); !status) return status.error();
    if (camera->mode_.rate_hz > 0.0) camera->rig_.rate_hz = camera->mode_.rate_hz;
    return camera;
}

Status LiveCamera::connect() {
    Result<V4l2Device> device = V4l2Device::open(*system_, address_.device);
    if (!device) return device.error();
    device_.emplace(std::move(device).value());
    const auto set_up = [this]() -> Status {
        const Result<VideoMode> mode = chosen_mode(*device_);
        if (!mode) return mode.error();
        mode_ = *mode;
        if (Status status = device_->set_mode(mode_); !status) return status;
        if (Status status = set_controls(*device_); !status) return status;
        return device_->start();
    };
    Status status = set_up();
    last_sequence_.reset();
    waited_ms_ = 0;
    if (status) {
        exposure_ns_ = known_exposure_ns(*device_);
    } else {
        device_.reset();
    }
    return status;
}

void LiveCamera::disconnect(std::string why) {
    device_.reset();
    lost_because_ = std::move(why);
}

Status LiveCamera::reconnect() {
    // in range: describe() limits it to 3600 s
    const int limit_ms = static_cast<int>(std::lround(1e3 * config_.reconnect_s));
    while (silent_ms_ < limit_ms && !(stop_ && stop_())) {
        system_->pause(kRetry_ms);
        silent_ms_ += kRetry_ms;
        const Status status = connect();
        if (status) {
            ++frame_status_.reconnected;
            return {};
        }
        lost_because_ = status.error().message;
    }
    if (stop_ && stop_()) return {};
    return input_error(
        fmt::format("{}: no frame for {:.1f} s after {} frames ({}); check cable and "
                    "power (live.reconnect_s = {:g})",
                    info_.path,
                    1e-3 * silent_ms_,
                    index_,
                    lost_because_,
                    config_.reconnect_s));
}

void LiveCamera::count_silence() {
    silent_ms_ += kSlice_ms;
    waited_ms_ += kSlice_ms;
    if (waited_ms_ >= 1e3 * config_.timeout_s)
        disconnect(fmt::format("silent for {:g} s", config_.timeout_s));
}

void LiveCamera::count_sequence(const VideoBuffer& buffer) {
    const std::uint32_t step = last_sequence_ ? buffer.sequence - *last_sequence_ : 1;  // wraps
    if (step > 1 && step <= kMaxDropped) frame_status_.dropped += static_cast<int>(step - 1);
    last_sequence_ = buffer.sequence;
}

Result<std::optional<VideoBuffer>> LiveCamera::newest() {
    Result<std::optional<VideoBuffer>> buffer = device_->dequeue(kSlice_ms);
    if (!buffer || !buffer->has_value()) return buffer;
    count_sequence(**buffer);
    std::size_t taken = 1;
    for (; taken < device_->buffers(); ++taken) {
        Result<std::optional<VideoBuffer>> newer = device_->dequeue(0);
        if (!newer) return newer;
        if (!newer->has_value()) return buffer;
        count_sequence(**newer);
        if (Status status = device_->give_back(**buffer); !status) return status.error();
        ++frame_status_.skipped;
        buffer = std::move(newer);
    }
    // All buffers were full, so the driver could not write. Even the newest image can be old: drop
    // it.
    if (Status status = device_->give_back(**buffer); !status) return status.error();
    ++frame_status_.skipped;
    buffer = device_->dequeue(kSlice_ms);
    if (buffer && buffer->has_value()) count_sequence(**buffer);
    return buffer;
}

Result<std::optional<StereoFrame>> LiveCamera::next() {
    while (!(stop_ && stop_())) {
        if (!device_) {
            if (Status status = reconnect(); !status) return status.error();
            continue;
        }
        const Result<std::optional<VideoBuffer>> buffer = newest();
        if (!buffer) {
            disconnect(buffer.error().message);
            continue;
        }
        if (!buffer->has_value()) {
            count_silence();
            continue;
        }
        Result<std::optional<StereoFrame>> frame = frame_of(**buffer);
        if (Status status = device_->give_back(**buffer); !status)
            disconnect(status.error().message);
        if (!frame || frame->has_value()) return frame;
    }
    return std::optional<StereoFrame>();
}

Result<std::optional<StereoFrame>> LiveCamera::frame_of(const VideoBuffer& buffer) {
    if (!buffer.monotonic) {
        return input_error(info_.path +
                           ": the driver's time stamps do not use CLOCK_MONOTONIC, so the age of a "
                           "frame is unknown; use another camera or driver");
    }
    StereoFrame frame;
    frame.time_ns = middle_of_exposure_ns(buffer);
    Status status;
    if (last_time_ns_ && frame.time_ns <= *last_time_ns_)
        status = input_error("the time stamp does not increase");
    if (buffer.damaged) status = input_error("the driver reports a damaged image");
    if (status) {
        const Result<GreyImage> image = decode(buffer);
        status =
            image ? split_side_by_side(*image, rig_, info_.path, frame) : Status(image.error());
    }
    if (!status) {
        ++frame_status_.damaged;
        if (++damaged_in_a_row_ < config_.max_damaged) return std::optional<StereoFrame>();
        return input_error(
            fmt::format("{}: {} frames in a row cannot be used. Reason for the last frame: {}. "
                        "Check the cable, or choose a smaller or slower mode",
                        info_.path,
                        damaged_in_a_row_,
                        status.error().message));
    }
    damaged_in_a_row_ = silent_ms_ = waited_ms_ = 0;
    last_time_ns_ = frame.time_ns;
    frame.index = index_++;
    frame.frame_status = std::exchange(frame_status_, {});
    return std::optional<StereoFrame>(std::move(frame));
}

Result<GreyImage> LiveCamera::decode(const VideoBuffer& buffer) const {
    if (mode_.format == PixelFormat::yuyv) return grey_of_yuyv(buffer, mode_);
    return parse_grey_image(
        {reinterpret_cast<const char*>(buffer.bytes.data()), buffer.bytes.size()}, info_.path);
}

std::int64_t LiveCamera::middle_of_exposure_ns(const VideoBuffer& buffer) const {
    // in range: describe() limits it to 1000 ms
    const auto readout_ns = static_cast<std::int64_t>(std::llround(1e6 * config_.readout_ms));
    const std::int64_t half_ns = (exposure_ns_ + readout_ns) / 2;
    return buffer.at_exposure_start ? buffer.time_ns + half_ns : buffer.time_ns - half_ns;
}

}  // namespace surefoot::io
