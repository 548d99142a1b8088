// SPDX-License-Identifier: Apache-2.0
#include "studies/simulation/copy_frames.hpp"

#include <fmt/format.h>

#include "service/console/interrupt.hpp"
#include "service/console/progress.hpp"

namespace surefoot::app {
namespace {

/// Copies the next frame. Returns false at the end of the source.
Result<bool> copy_one(camera::FrameSource& source,
                      io::Recorder& recorder,
                      const std::function<Status(const StereoFrame&)>& after_frame) {
    if (interrupted()) {
        return Error{ErrorCode::interrupted,
                     "interrupted by the user; the frames up to here are kept"};
    }
    const auto frame = source.next();
    if (!frame) return frame.error();
    if (!frame->has_value()) return false;
    if (auto status = recorder.add(**frame); !status) return status.error();
    if (after_frame) {
        if (auto status = after_frame(**frame); !status) return status.error();
    }
    return true;
}

}  // namespace

Result<io::Recorder> start_recording(const std::string& folder,
                                     const camera::FrameSource& source,
                                     io::Recorder::Existing existing) {
    if (source.info().modelled_depth) {
        return usage_error(
            fmt::format("{}: sim.sensor = analytic makes no images to record in {}; use 'surefoot "
                        "run sim:{}' instead",
                        source.info().path,
                        folder,
                        source.info().path));
    }
    return io::Recorder::create(folder, source.rig(), existing);
}

Copied copy_frames(const std::string& label,
                   camera::FrameSource& source,
                   io::Recorder& recorder,
                   const std::function<Status(const StereoFrame&)>& after_frame) {
    watch_for_interrupts();
    Progress progress(label, source.info().frames);
    Copied copied;
    while (true) {
        const auto copied_one = copy_one(source, recorder, after_frame);
        copied.frames = recorder.frames();
        copied.broken = source.info().broken;
        if (!copied_one) copied.error = copied_one.error();
        if (!copied_one || !*copied_one) break;
        progress.advance(copied.frames);
    }
    if (auto status = recorder.finish(); !status && !copied.error) copied.error = status.error();
    return copied;
}

}  // namespace surefoot::app
