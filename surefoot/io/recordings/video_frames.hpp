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
    /// As the container says. Where it has no times, index / rate; nothing without a rate either.
    std::optional<std::int64_t> time_ns;
};

/// Frames of a video file as grey images with the times of its container, without asking for a rig.
class VideoFrames {
  public:
    /// Regular files only.
    [[nodiscard]] static Result<VideoFrames> open(const std::string& path);
    ~VideoFrames();
    VideoFrames(VideoFrames&&) noexcept;
    VideoFrames& operator=(VideoFrames&&) noexcept;

    /// How many frames the container announces, which may be wrong; 0 = it does not say.
    [[nodiscard]] int count() const;
    /// Mean rate that the container announces [Hz]; 0 = none between 0.1 and 1000.
    [[nodiscard]] double rate_hz() const;
    [[nodiscard]] int width() const;
    [[nodiscard]] int height() const;
    /// Nothing at the end. A video that breaks off before the end that its container announces is
    /// an error, said once; its last frame is then not given, because it may be cut off.
    [[nodiscard]] Result<std::optional<VideoFrame>> next();

  private:
    struct Impl;
    explicit VideoFrames(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace surefoot::io
