// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "surefoot/camera/frame_source.hpp"
#include "surefoot/io/recordings/recorder.hpp"

namespace surefoot::app {

/// Result of copying: the number of frames copied, and the error that ended the copy early.
struct Copied {
    int frames = 0;
    camera::BrokenFrames broken = {};  ///< frames that the source skipped as broken
    std::optional<Error> error;  ///< error of source, recorder or `after_frame`, or user interrupt
};

/// Creates a recording for the frames of `source`. A source without images is a usage error.
[[nodiscard]] Result<io::Recorder> start_recording(
    const std::string& folder,
    const camera::FrameSource& source,
    io::Recorder::Existing existing = io::Recorder::Existing::refuse);

/// Copies all frames of `source` into `recorder`, shows progress under `label`, and closes the
/// recording. If an error ends the copy, the frames before it form a valid recording. `after_frame`
/// runs after each copied frame and may write more data.
[[nodiscard]] Copied copy_frames(const std::string& label,
                                 camera::FrameSource& source,
                                 io::Recorder& recorder,
                                 const std::function<Status(const StereoFrame&)>& after_frame = {});

}  // namespace surefoot::app
