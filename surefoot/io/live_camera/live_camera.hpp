// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "surefoot/camera/frame_source.hpp"
#include "surefoot/core/config.hpp"
#include "surefoot/io/live_camera/v4l2_device.hpp"

namespace surefoot::io {

enum class AutoControl : std::uint8_t { keep, on, off };
enum class FormatChoice : std::uint8_t { any, yuyv, mjpeg };

/// Settings of a live camera.
struct CameraConfig {
    double exposure_ms = 0.0;  ///< exposure time [ms]; 0 = unchanged
    int gain = -1;             ///< gain in the driver's units; -1 = unchanged
    int white_balance_k = 0;   ///< colour temperature [K]; 0 = unchanged
    AutoControl automatic = AutoControl::keep;
    FormatChoice format = FormatChoice::any;
    double readout_ms = 0.0;    ///< time from first to last row [ms]; 0 = global shutter
    double timeout_s = 1.0;     ///< longest time without a frame until the device is reopened [s]
    double reconnect_s = 10.0;  ///< longest time without a frame until the run ends [s]
    int max_damaged = 30;       ///< number of unusable frames in a row that ends the run

    void describe(ConfigVisitor& visitor);
    /// Returns a problem if a manual value is set together with `auto = on`.
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// Address "DEVICE[@WIDTHxHEIGHT[@RATE]]", for example "/dev/video0@1344x376@30". Width and height
/// are those of the whole image with both cameras side by side, as the driver lists them.
struct LiveAddress {
    std::string device;
    std::optional<int> width;  ///< image width; set together with height
    std::optional<int> height;
    std::optional<double> rate_hz;
};
[[nodiscard]] Result<LiveAddress> parse_live_address(std::string_view text);

/// Reads frames of a side-by-side stereo camera on V4L2, in YUYV or MJPEG.
///
/// * `next` waits for an image and returns the newest one. `StereoFrame::frame_status` counts the
///   images skipped, lost by the device or damaged since the previous frame. If all buffers were
///   full, the driver had stopped writing, and `next` waits for a fresh image.
/// * Stamps are `CLOCK_MONOTONIC`, in the middle of the exposure of the middle row:
///       start-of-exposure stamps:  t + exposure / 2 + readout / 2
///       end-of-frame stamps:       t - exposure / 2 - readout / 2
///   `t` is the driver's stamp. `exposure` is `exposure_ms`, or else the camera's manual value. An
///   unknown (automatic) exposure counts as 0; stamps can then be off by half an exposure.
/// * A device that disappears or is silent for `timeout_s` is closed and reopened until frames come
///   or `reconnect_s` has passed. These times are sums of the waits: the library reads no
///   clock.
///
/// All work happens inside `next`, in the caller's thread.
class LiveCamera final : public camera::FrameSource {
  public:
    /// Polls `stop` while waiting; true ends the source. `stop` may be empty.
    [[nodiscard]] static Result<std::unique_ptr<LiveCamera>> open(
        std::unique_ptr<VideoDevice> system,
        const LiveAddress& address,
        const camera::StereoRig& rig,
        const CameraConfig& config,
        std::function<bool()> stop = {});

    [[nodiscard]] const camera::StereoRig& rig() const override { return rig_; }
    [[nodiscard]] const camera::SourceInfo& info() const override { return info_; }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override;

    static constexpr int kRetry_ms = 200;  ///< pause between two attempts to open
    static constexpr int kSlice_ms = 100;  ///< longest wait between two polls of `stop`

  private:
    LiveCamera(std::unique_ptr<VideoDevice> system,
               const LiveAddress& address,
               const camera::StereoRig& rig,
               const CameraConfig& config,
               std::function<bool()> stop);

    [[nodiscard]] Status connect();
    [[nodiscard]] Status reconnect();
    void disconnect(std::string why);
    [[nodiscard]] Result<VideoMode> chosen_mode(V4l2Device& device) const;
    [[nodiscard]] Status set_controls(V4l2Device& device) const;
    [[nodiscard]] Result<std::optional<VideoBuffer>> newest();
    void count_silence();
    /// Returns the exposure in ns; 0 = unknown (automatic, or not readable).
    [[nodiscard]] std::int64_t known_exposure_ns(V4l2Device& device) const;
    void count_sequence(const VideoBuffer& buffer);
    /// Converts the image to a frame. No value if it is unusable; an error after too many in a row.
    [[nodiscard]] Result<std::optional<StereoFrame>> frame_of(const VideoBuffer& buffer);
    [[nodiscard]] Result<GreyImage> decode(const VideoBuffer& buffer) const;
    [[nodiscard]] std::int64_t middle_of_exposure_ns(const VideoBuffer& buffer) const;

    std::unique_ptr<VideoDevice> system_;
    LiveAddress address_;
    camera::StereoRig rig_;
    camera::SourceInfo info_;
    CameraConfig config_;
    std::function<bool()> stop_;
    std::optional<V4l2Device> device_;  // declared after system_, so that it is destroyed first
    VideoMode mode_;
    std::int64_t exposure_ns_ = 0;  ///< exposure time in use; 0 = not known
    std::string lost_because_;
    int silent_ms_ = 0;  ///< waiting time since the last usable frame [ms]
    int waited_ms_ = 0;  ///< part of silent_ms_ since the device was opened
    int damaged_in_a_row_ = 0;
    int index_ = 0;
    FrameStatus frame_status_;  ///< images skipped, lost or damaged since the last frame
    std::optional<std::uint32_t> last_sequence_;
    std::optional<std::int64_t> last_time_ns_;
};

}  // namespace surefoot::io
