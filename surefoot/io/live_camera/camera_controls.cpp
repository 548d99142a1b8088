// SPDX-License-Identifier: Apache-2.0
// Handles the settings, address, mode and controls of a live camera.
#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cmath>

#include "surefoot/io/live_camera/live_camera.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

/// V4L2_CID_EXPOSURE_ABSOLUTE counts in 100 us (kernel documentation, camera controls).
constexpr double kExposureUnits_per_ms = 10.0;
constexpr std::int64_t kExposureUnit_ns = 100'000;

bool rate_matches(const VideoMode& mode, const std::optional<double>& rate_hz) {
    return !rate_hz || mode.rate_hz == 0.0 || std::abs(mode.rate_hz - *rate_hz) < 0.02 * *rate_hz;
}

std::string list_of(const std::vector<VideoMode>& modes) {
    std::string text;
    for (const VideoMode& mode : modes) {
        text += fmt::format("{}{} {}x{}@{:.4g}",
                            text.empty() ? "" : ", ",
                            mode.fourcc,
                            mode.width,
                            mode.height,
                            mode.rate_hz);
    }
    return text.empty() ? "nothing" : text;
}

Status set_automatic(V4l2Device& device, bool on) {
    if (device.control(V4L2_CID_EXPOSURE_AUTO)) {
        // This control is a menu. UVC cameras offer two entries: manual and one of the two
        // automatic modes.
        constexpr int kOff = V4L2_EXPOSURE_MANUAL;
        Status status = device.set_control(
            V4L2_CID_EXPOSURE_AUTO, "live.auto", on ? V4L2_EXPOSURE_APERTURE_PRIORITY : kOff);
        if (!status && on)
            status = device.set_control(V4L2_CID_EXPOSURE_AUTO, "live.auto", V4L2_EXPOSURE_AUTO);
        if (!status) return status;
    }
    for (const std::uint32_t id :
         {std::uint32_t{V4L2_CID_AUTOGAIN}, std::uint32_t{V4L2_CID_AUTO_WHITE_BALANCE}}) {
        if (!device.control(id)) continue;
        if (Status status = device.set_control(id, "live.auto", on ? 1 : 0); !status) return status;
    }
    return {};
}

/// Switches the automatic mode off first: otherwise drivers refuse or ignore a manual value.
Status set_manual(V4l2Device& device,
                  std::uint32_t automatic_id,
                  int automatic_off,
                  std::uint32_t id,
                  const std::string& name,
                  int value) {
    if (device.control(automatic_id)) {
        if (Status status = device.set_control(automatic_id, name, automatic_off); !status)
            return status;
    }
    return device.set_control(id, name, value);
}

}  // namespace

void CameraConfig::describe(ConfigVisitor& visitor) {
    static constexpr const char* kAutoNames[] = {"keep", "on", "off"};
    static constexpr const char* kFormatNames[] = {"any", "yuyv", "mjpeg"};
    visitor.number("exposure_ms",
                   exposure_ms,
                   0.0,
                   1000.0,
                   "live cameras: exposure time in milliseconds; a value above 0 switches "
                   "automatic exposure off, 0 leaves the exposure unchanged");
    visitor.integer("gain",
                    gain,
                    -1,
                    1'000'000,
                    "live cameras: gain in the units of the driver ('surefoot info' lists the "
                    "range); -1 leaves the gain unchanged");
    visitor.integer("white_balance_k",
                    white_balance_k,
                    0,
                    20'000,
                    "live cameras: colour temperature of the white balance in kelvin; 0 leaves the "
                    "white balance unchanged");
    visitor.enumeration("auto",
                        automatic,
                        kAutoNames,
                        "live cameras: on or off switches automatic exposure, gain and white "
                        "balance on or off; keep leaves these three settings unchanged");
    visitor.enumeration("format",
                        format,
                        kFormatNames,
                        "live cameras: pixel format of the images; any uses yuyv if the camera has "
                        "it, otherwise mjpeg");
    visitor.number("readout_ms",
                   readout_ms,
                   0.0,
                   1000.0,
                   "live cameras: time in milliseconds from the first to the last row of a rolling "
                   "shutter; 0 is a global shutter. Time stamps refer to the middle row");
    visitor.number(
        "timeout_s",
        timeout_s,
        0.2,
        60.0,
        "live cameras: time in seconds without a frame after which the device is opened again");
    visitor.number("reconnect_s",
                   reconnect_s,
                   0.0,
                   3600.0,
                   "live cameras: time in seconds without a frame after which the run ends");
    visitor.integer("max_damaged",
                    max_damaged,
                    1,
                    100'000,
                    "live cameras: number of unusable frames in a row after which the run ends");
}

std::optional<std::string> CameraConfig::problem() const {
    const bool manual = exposure_ms > 0.0 || gain >= 0 || white_balance_k > 0;
    if (!manual || automatic != AutoControl::on) return std::nullopt;
    return "live.auto is on, but live.exposure_ms, live.gain or live.white_balance_k sets a fixed "
           "value. Set live.auto to off, or remove the fixed values";
}

Result<LiveAddress> parse_live_address(std::string_view text) {
    LiveAddress address;
    const std::vector<std::string_view> parts = split(text, "@");
    const auto wrong = [&] {
        return usage_error(
            fmt::format("v4l2:{}: expected v4l2:DEVICE[@WIDTHxHEIGHT[@RATE]], for example "
                        "v4l2:/dev/video0@1344x376@30 (WIDTH is that of both cameras side by side)",
                        text));
    };
    if (parts.empty() || parts.size() > 3 || !parts[0].starts_with("/") || text.ends_with("@"))
        return wrong();
    address.device = std::string(parts[0]);
    if (parts.size() < 2) return address;
    const std::vector<std::string_view> size = split(parts[1], "x");
    if (size.size() != 2) return wrong();
    constexpr std::int64_t kMaxSide_px = 1 << 15;
    const auto width = parse_int64(size[0]);
    const auto height = parse_int64(size[1]);
    if (!width || !height || *width < 2 || *height < 1 || *width % 2 != 0 || *width > kMaxSide_px ||
        *height > kMaxSide_px) {
        return wrong();
    }
    address.width = static_cast<int>(*width);
    address.height = static_cast<int>(*height);
    if (parts.size() == 3) {
        address.rate_hz = parse_double(parts[2]);
        if (!address.rate_hz || !(*address.rate_hz >= 0.1 && *address.rate_hz <= 1000.0))
            return wrong();
    }
    return address;
}

Result<VideoMode> LiveCamera::chosen_mode(V4l2Device& device) const {
    const std::vector<VideoMode> modes = device.modes();
    const int width = 2 * rig_.left.width;
    const auto fits = [&](const VideoMode& mode, PixelFormat format) {
        const bool wanted = config_.format == FormatChoice::any ||
                            (config_.format == FormatChoice::yuyv) == (format == PixelFormat::yuyv);
        return wanted && mode.format == format && mode.width == width &&
               mode.height == rig_.left.height && rate_matches(mode, address_.rate_hz);
    };
    for (const PixelFormat format : {PixelFormat::yuyv, PixelFormat::mjpeg}) {
        const auto mode = std::find_if(
            modes.begin(), modes.end(), [&](const VideoMode& m) { return fits(m, format); });
        if (mode == modes.end()) continue;
        VideoMode chosen = *mode;
        if (address_.rate_hz) chosen.rate_hz = *address_.rate_hz;
        return chosen;
    }
    return usage_error(
        fmt::format("{}: the camera has no YUYV or MJPEG mode of {} x {} px{}{}; it has {}",
                    info_.path,
                    width,
                    rig_.left.height,
                    address_.rate_hz ? fmt::format(" at {:g} Hz", *address_.rate_hz) : "",
                    config_.format == FormatChoice::any ? "" : " in the format of live.format",
                    list_of(modes)));
}

Status LiveCamera::set_controls(V4l2Device& device) const {
    if (config_.automatic != AutoControl::keep) {
        Status status = set_automatic(device, config_.automatic == AutoControl::on);
        if (!status) return status;
    }
    if (config_.exposure_ms > 0.0) {
        const int value =
            // in range: describe() limits it to 1000 ms
            static_cast<int>(std::lround(config_.exposure_ms * kExposureUnits_per_ms));
        Status status = set_manual(device,
                                   V4L2_CID_EXPOSURE_AUTO,
                                   V4L2_EXPOSURE_MANUAL,
                                   V4L2_CID_EXPOSURE_ABSOLUTE,
                                   "live.exposure_ms (in 0.1 ms)",
                                   value);
        if (!status) return status;
    }
    if (config_.gain >= 0) {
        Status status =
            set_manual(device, V4L2_CID_AUTOGAIN, 0, V4L2_CID_GAIN, "live.gain", config_.gain);
        if (!status) return status;
    }
    if (config_.white_balance_k == 0) return {};
    return set_manual(device,
                      V4L2_CID_AUTO_WHITE_BALANCE,
                      0,
                      V4L2_CID_WHITE_BALANCE_TEMPERATURE,
                      "live.white_balance_k",
                      config_.white_balance_k);
}

std::int64_t LiveCamera::known_exposure_ns(V4l2Device& device) const {
    if (config_.exposure_ms > 0.0)
        // in range: describe() limits it to 1000 ms
        return static_cast<std::int64_t>(std::llround(1e6 * config_.exposure_ms));
    const auto automatic = device.control(V4L2_CID_EXPOSURE_AUTO);
    if (!automatic || automatic->value != V4L2_EXPOSURE_MANUAL) return 0;
    const auto exposure = device.control(V4L2_CID_EXPOSURE_ABSOLUTE);
    return exposure ? kExposureUnit_ns * exposure->value.value_or(0) : 0;
}

}  // namespace surefoot::io
