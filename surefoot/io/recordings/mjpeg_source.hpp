// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "surefoot/io/recordings/recording.hpp"

namespace surefoot::io {

/// Position of a JPEG in a stream: the bytes from `begin` up to, but not including, `end`.
struct JpegSpan {
    std::size_t begin = 0;
    std::size_t end = 0;
};
/// Finds the first image of concatenated JPEGs; no value while its end is missing. Bytes between
/// images are skipped. Walks from segment to segment, so that the end marker of an embedded
/// thumbnail does not end the image. A damaged image ends where the next image begins.
[[nodiscard]] std::optional<JpegSpan> first_jpeg(std::string_view bytes);

/// Opens a file of concatenated JPEGs (.mjpeg, .mjpg) from `v4l2-ctl --stream-to` or FFmpeg, with
/// side-by-side frames at a constant rate. A damaged image is an error; the next call continues
/// after it.
[[nodiscard]] Result<std::unique_ptr<camera::FrameSource>> open_mjpeg(const std::string& path,
                                                                      const camera::StereoRig& rig,
                                                                      double rate_hz);

}  // namespace surefoot::io
