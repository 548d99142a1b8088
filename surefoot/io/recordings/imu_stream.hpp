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

/// Time span of the IMU samples for the first frame, which has no previous frame.
inline constexpr std::int64_t kFirstImuSpan_ns = 1'000'000'000;

/// Reads IMU samples from EuRoC csv rows (stamp_ns, angular velocity [rad/s], specific force
/// [m/s^2]). The source is a file, a growing file, or a FIFO. Reading never blocks: missing rows
/// are read later. A line counts only when it is complete.
class ImuStream {
  public:
    [[nodiscard]] static Result<ImuStream> open(const std::string& path);

    /// Returns all new samples up to a time, in time order. Stamps must increase.
    [[nodiscard]] Result<std::vector<ImuSample>> take_until(std::int64_t time_ns);

  private:
    explicit ImuStream(files::InputFile file) : file_(std::move(file)) {}
    /// Reads available bytes; returns false if there were none.
    [[nodiscard]] Result<bool> read_some();

    files::InputFile file_;
    std::string unread_;  ///< incomplete last line
    std::deque<ImuSample> waiting_;
    std::int64_t last_time_ns_ = -1;
};

/// Combines frames of one source with IMU samples of another. Both must use the same time origin
/// (`CLOCK_MONOTONIC` for live cameras). Late samples are added to the next frame. Fails if the
/// source already has an IMU, or if its rig has no IMU mount.
[[nodiscard]] Result<std::unique_ptr<camera::FrameSource>> with_imu(
    std::unique_ptr<camera::FrameSource> source, const std::string& imu_path);

}  // namespace surefoot::io
