// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "surefoot/camera/frame_source.hpp"
#include "surefoot/io/recordings/recorder.hpp"

namespace surefoot::app {

/// How far copying got, and why it ended early.
struct Copied {
    int frames = 0;
    camera::BrokenFrames broken = {};  ///< that the source passed over
    std::optional<Error> error;  ///< of source, recorder or `after_frame`; or the user's interrupt
};

/// Starts a recording of a source. A source without images is a usage error.
[[nodiscard]] Result<io::Recorder> start_recording(
    const std::string& folder,
    const camera::FrameSource& source,
    io::Recorder::Existing existing = io::Recorder::Existing::refuse);

/// Copies a source into a recording and closes it, frame by frame, with progress under `label`.
/// What was copied before an error is a valid recording. `after_frame` may write more of each
/// frame.
[[nodiscard]] Copied copy_frames(const std::string& label,
                                 camera::FrameSource& source,
                                 io::Recorder& recorder,
                                 const std::function<Status(const StereoFrame&)>& after_frame = {});

}  // namespace surefoot::app
