// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::io {

struct VideoFrame {
    GreyImage image;
    /// Time from the container, otherwise index / rate. No value if it has neither times nor rate.
    std::optional<std::int64_t> time_ns;
};

/// Reads grey frames of a video file with the times of its container; needs no rig.
class VideoFrames {
  public:
    /// Opens regular files only.
    [[nodiscard]] static Result<VideoFrames> open(const std::string& path);
    ~VideoFrames();
    VideoFrames(VideoFrames&&) noexcept;
    VideoFrames& operator=(VideoFrames&&) noexcept;

    /// Returns the frame count that the container announces; may be wrong; 0 = not announced.
    [[nodiscard]] int count() const;
    /// Returns the mean rate that the container announces [Hz]; 0 = no rate between 0.1 and 1000.
    [[nodiscard]] double rate_hz() const;
    [[nodiscard]] int width() const;
    [[nodiscard]] int height() const;
    /// Returns the next frame; no value at the end. If the video stops before the end that its
    /// container announces, returns one error and drops the last frame, which may be truncated.
    [[nodiscard]] Result<std::optional<VideoFrame>> next();

  private:
    struct Impl;
    explicit VideoFrames(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace surefoot::io
