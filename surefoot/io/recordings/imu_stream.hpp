// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "surefoot/camera/frame_source.hpp"
#include "surefoot/files/input_file.hpp"

namespace surefoot::io {

/// The first frame has no predecessor: it gets at most this much of the IMU's past.
inline constexpr std::int64_t kFirstImuSpan_ns = 1'000'000'000;

/// IMU samples as EuRoC csv rows (stamp_ns, angular velocity [rad/s], specific force [m/s^2]) from
/// a file, a file that still grows, or a FIFO that another program writes. Reading never waits:
/// what is not there yet comes later. A line counts once its end is there.
class ImuStream {
  public:
    [[nodiscard]] static Result<ImuStream> open(const std::string& path);

    /// All samples up to a time that were not taken before, in time order. Stamps must grow.
    [[nodiscard]] Result<std::vector<ImuSample>> take_until(std::int64_t time_ns);

  private:
    explicit ImuStream(files::InputFile file) : file_(std::move(file)) {}
    /// Whether anything came.
    [[nodiscard]] Result<bool> read_some();

    files::InputFile file_;
    std::string unread_;  ///< the beginning of a line
    std::deque<ImuSample> waiting_;
    std::int64_t last_time_ns_ = -1;
};

/// Frames of one source with the IMU of another; both must count time from the same origin
/// (`CLOCK_MONOTONIC` for live cameras). Samples that come late go with the next frame. Fails for a
/// source that has an IMU already, or whose rig does not say where the IMU is.
[[nodiscard]] Result<std::unique_ptr<camera::FrameSource>> with_imu(
    std::unique_ptr<camera::FrameSource> source, const std::string& imu_path);

}  // namespace surefoot::io
