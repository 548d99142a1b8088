// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::io {

/// Frames of a video file as grey images, without asking for a rig.
class VideoFrames {
  public:
    [[nodiscard]] static Result<VideoFrames> open(const std::string& path);
    ~VideoFrames();
    VideoFrames(VideoFrames&&) noexcept;
    VideoFrames& operator=(VideoFrames&&) noexcept;

    /// How many there are by the container's own account, which may be wrong; 0 = unknown.
    [[nodiscard]] int count() const;
    /// Nothing at the end.
    [[nodiscard]] Result<std::optional<GreyImage>> next();

  private:
    struct Impl;
    explicit VideoFrames(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace surefoot::io
