// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "surefoot/io/recordings/recording.hpp"

namespace surefoot::io {

/// Where the first JPEG of a stream lies; `end` is one behind its end marker.
struct JpegSpan {
    std::size_t begin = 0;
    std::size_t end = 0;
};
/// The first image of concatenated JPEGs, or nothing while its end is not there. What lies between
/// images is passed over. Markers are walked segment by segment, so that the end marker of an
/// embedded thumbnail is not taken for the image's; a damaged image ends where the next begins.
[[nodiscard]] std::optional<JpegSpan> first_jpeg(std::string_view bytes);

/// A file of concatenated JPEGs (.mjpeg, .mjpg), as `v4l2-ctl --stream-to` and FFmpeg write them,
/// with side-by-side frames at a constant rate. A damaged image is an error; the next call goes on
/// behind it.
[[nodiscard]] Result<std::unique_ptr<camera::FrameSource>> open_mjpeg(const std::string& path,
                                                                      const camera::StereoRig& rig,
                                                                      double rate_hz);

}  // namespace surefoot::io
