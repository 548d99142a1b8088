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

/// One way in which the camera can deliver images.
struct VideoMode {
    PixelFormat format = PixelFormat::other;
    std::string fourcc;  ///< "YUYV", "MJPG", ...
    int width = 0;       ///< of the whole image: both eyes of a side-by-side camera
    int height = 0;
    double rate_hz = 0.0;  ///< 0 = not known, or the driver's choice
};

/// A number of the camera that can be set.
struct VideoControl {
    std::uint32_t id = 0;  ///< V4L2_CID_*
    std::string name;      ///< as the driver calls it
    int min = 0;
    int max = 0;
    int step = 1;
    std::optional<int> value;  ///< nothing when it cannot be read now
    bool writable = false;     ///< false also while an automatic mode owns it
};

/// An image in the driver's memory; valid until it is given back.
struct VideoBuffer {
    std::span<const std::uint8_t> bytes;
    int bytes_per_line = 0;
    std::int64_t time_ns = 0;  ///< the driver's stamp, in `CLOCK_MONOTONIC` if `monotonic`
    bool monotonic = false;
    bool at_exposure_start = false;  ///< the stamp's instant; false = end of the frame's transfer
    std::uint32_t sequence = 0;      ///< the driver's frame counter
    bool damaged = false;            ///< the driver itself says so
    std::uint32_t slot = 0;
};

/// A V4L2 capture device (single-planar, memory-mapped streaming): query, set, stream.
/// Kernel documentation "Video for Linux API", Part I, chapters 1 and 3. Closed by the destructor.
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
    /// Sets and reads back; a value out of range is an error that names the range.
    [[nodiscard]] Status set_control(std::uint32_t id, const std::string& name, int value);

    /// Asks for the mode and reads back what the driver made of it; another one is an error.
    [[nodiscard]] Status set_mode(const VideoMode& mode);
    [[nodiscard]] Status start();
    /// The oldest waiting image, or nothing within the time. An error means that the device is
    /// gone or stopped.
    [[nodiscard]] Result<std::optional<VideoBuffer>> dequeue(int timeout_ms);
    [[nodiscard]] Status give_back(const VideoBuffer& buffer);

    /// How many buffers the driver granted.
    [[nodiscard]] std::size_t buffers() const noexcept { return mappings_.size(); }

    /// Asked for: enough for a consumer that is late by two frames.
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

    VideoDevice* system_;  // null after a move
    std::string path_;
    std::string card_;
    std::string driver_;
    int bytes_per_line_ = 0;
    std::vector<Mapping> mappings_;
};

}  // namespace surefoot::io
