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

/// How a live camera is used.
struct CameraConfig {
    double exposure_ms = 0.0;  ///< 0 = as the camera has it
    int gain = -1;             ///< in the driver's numbers; -1 = as the camera has it
    int white_balance_k = 0;   ///< 0 = as the camera has it
    AutoControl automatic = AutoControl::keep;
    FormatChoice format = FormatChoice::any;
    double readout_ms = 0.0;    ///< of the rolling shutter, first to last row; 0 = global shutter
    double timeout_s = 1.0;     ///< without a frame, after which the device counts as gone
    double reconnect_s = 10.0;  ///< without a frame, after which the run ends
    int max_damaged = 30;       ///< frames in a row that cannot be used, after which the run ends

    void describe(ConfigVisitor& visitor);
    /// Manual values and `auto = on` contradict each other.
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// "DEVICE[@WIDTHxHEIGHT@RATE]", for example "/dev/video0@1344x376@30"; sizes are those of the
/// whole image with both eyes, as the driver lists them.
struct LiveAddress {
    std::string device;
    std::optional<int> width;  ///< both or none
    std::optional<int> height;
    std::optional<double> rate_hz;
};
[[nodiscard]] Result<LiveAddress> parse_live_address(std::string_view text);

/// Frames of a side-by-side stereo camera on V4L2, YUYV or MJPEG.
///
/// * `next` waits for an image and gives the newest that is there; how many were passed over,
///   lost by the device or damaged since the previous frame is in `StereoFrame::arrival`. When
///   all buffers were full, the driver had stopped to write, and a fresh image is waited for.
/// * Stamps are `CLOCK_MONOTONIC`, in the middle of the exposure of the middle row:
///       start-of-exposure stamps:  t + exposure / 2 + readout / 2
///       end-of-frame stamps:       t - exposure / 2 - readout / 2
///   with the exposure that was set; one that the camera chooses itself is not known and counts
///   as 0, so that such stamps are up to half an exposure off.
/// * A device that disappears or is silent for `timeout_s` is closed and opened again until frames
///   come or `reconnect_s` are over. These times are the sum of the waits: the library reads no
///   clock.
///
/// Everything happens inside `next`, in the caller's thread.
class LiveCamera final : public camera::FrameSource {
  public:
    /// `stop`: asked while waiting; true ends the source. May be empty.
    [[nodiscard]] static Result<std::unique_ptr<LiveCamera>> open(
        std::unique_ptr<VideoDevice> system,
        const LiveAddress& address,
        const camera::StereoRig& rig,
        const CameraConfig& config,
        std::function<bool()> stop = {});

    [[nodiscard]] const camera::StereoRig& rig() const override { return rig_; }
    [[nodiscard]] const camera::SourceInfo& info() const override { return info_; }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override;

    static constexpr int kRetry_ms = 200;  ///< between two attempts to open
    static constexpr int kSlice_ms = 100;  ///< of waiting, between two looks at `stop`

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
    /// The exposure as far as it is known; 0 where the camera chooses it.
    [[nodiscard]] std::int64_t known_exposure_ns(V4l2Device& device) const;
    void count_sequence(const VideoBuffer& buffer);
    /// The image as a frame, or nothing after counting it as damaged.
    [[nodiscard]] Result<std::optional<StereoFrame>> frame_of(const VideoBuffer& buffer);
    [[nodiscard]] Result<GreyImage> decode(const VideoBuffer& buffer) const;
    [[nodiscard]] std::int64_t middle_of_exposure_ns(const VideoBuffer& buffer) const;

    std::unique_ptr<VideoDevice> system_;
    LiveAddress address_;
    camera::StereoRig rig_;
    camera::SourceInfo info_;
    CameraConfig config_;
    std::function<bool()> stop_;
    std::optional<V4l2Device> device_;  // after system_: closed before it goes
    VideoMode mode_;
    std::int64_t exposure_ns_ = 0;  ///< 0 = not known
    std::string lost_because_;
    int silent_ms_ = 0;  ///< waited since the last usable frame
    int waited_ms_ = 0;  ///< of these, since the device was opened
    int damaged_in_a_row_ = 0;
    int index_ = 0;
    FrameStatus frame_status_;  ///< since the previous frame
    std::optional<std::uint32_t> last_sequence_;
    std::optional<std::int64_t> last_time_ns_;
};

}  // namespace surefoot::io
