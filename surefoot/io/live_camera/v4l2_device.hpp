// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/io/live_camera/video_device.hpp"

namespace surefoot::io {

enum class PixelFormat : std::uint8_t { yuyv, mjpeg, other };

/// One capture mode of the camera.
struct VideoMode {
    PixelFormat format = PixelFormat::other;
    std::string fourcc;  ///< "YUYV", "MJPG", ...
    int width = 0;       ///< width of the whole image: both cameras side by side
    int height = 0;
    double rate_hz = 0.0;  ///< frame rate; 0 = unknown, or the driver's choice
};

/// A control of the camera: a whole number, a switch (0 or 1) or the index of a menu entry.
struct VideoControl {
    std::uint32_t id = 0;  ///< V4L2_CID_*
    std::string name;      ///< name of the control in the driver
    int min = 0;
    int max = 0;
    int step = 1;
    std::optional<int> value;  ///< current value; no value if it cannot be read now
    bool writable = false;     ///< false also while an automatic mode sets the value
};

/// An image in the driver's memory; valid until it is returned to the driver.
struct VideoBuffer {
    std::span<const std::uint8_t> bytes;
    int bytes_per_line = 0;
    std::int64_t time_ns = 0;  ///< the driver's stamp, in `CLOCK_MONOTONIC` if `monotonic`
    bool monotonic = false;
    bool at_exposure_start = false;  ///< if false, the stamp is the end of the transfer
    std::uint32_t sequence = 0;      ///< the driver's frame counter
    bool damaged = false;            ///< true if the driver reports a damaged image
    std::uint32_t slot = 0;
};

/// Controls a V4L2 capture device (single-planar, memory-mapped streaming). Source: kernel
/// documentation "Video for Linux API", Part I, chapters 1 and 3. The destructor closes the device.
class V4l2Device {
  public:
    /// `system` must outlive the device.
    [[nodiscard]] static Result<V4l2Device> open(VideoDevice& system, const std::string& path);
    ~V4l2Device();
    V4l2Device(V4l2Device&& other) noexcept;
    V4l2Device& operator=(V4l2Device&&) = delete;

    [[nodiscard]] const std::string& card() const noexcept { return card_; }
    [[nodiscard]] const std::string& driver() const noexcept { return driver_; }
    [[nodiscard]] std::vector<VideoMode> modes();
    [[nodiscard]] std::vector<VideoControl> controls();
    [[nodiscard]] std::optional<VideoControl> control(std::uint32_t id);
    /// Sets a control and reads it back; a value out of range is an error that names the range.
    [[nodiscard]] Status set_control(std::uint32_t id, const std::string& name, int value);

    /// Requests the mode and reads back the driver's choice; a different mode is an error.
    [[nodiscard]] Status set_mode(const VideoMode& mode);
    [[nodiscard]] Status start();
    /// Returns the oldest waiting image; no value after the timeout. An error means that the device
    /// is gone or has stopped.
    [[nodiscard]] Result<std::optional<VideoBuffer>> dequeue(int timeout_ms);
    [[nodiscard]] Status give_back(const VideoBuffer& buffer);

    /// Returns the number of buffers that the driver granted.
    [[nodiscard]] std::size_t buffers() const noexcept { return mappings_.size(); }

    /// Requested number of buffers: enough for a consumer that is two frames late.
    static constexpr std::uint32_t kBuffers = 4;

  private:
    struct Mapping {
        const std::uint8_t* address = nullptr;
        std::size_t length = 0;
    };
    V4l2Device(VideoDevice& system, std::string path) : system_(&system), path_(std::move(path)) {}
    [[nodiscard]] Error failed(const std::string& what, int error_number) const;
    [[nodiscard]] Status set_rate(double rate_hz);
    [[nodiscard]] Status map_buffer(std::uint32_t slot);
    void add_sizes(std::uint32_t fourcc, std::vector<VideoMode>& modes);
    void add_rates(std::uint32_t fourcc, const VideoMode& mode, std::vector<VideoMode>& modes);

    VideoDevice* system_;  // nullptr after a move
    std::string path_;
    std::string card_;
    std::string driver_;
    int bytes_per_line_ = 0;
    std::vector<Mapping> mappings_;
};

}  // namespace surefoot::io
