// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/camera_monitor.hpp"

namespace surefoot::pipeline {

CameraState CameraMonitor::add(const FrameStatus& frame_status, ExposureState light) noexcept {
    const bool arrived = frame_status.is_new_and_whole();
    const bool good = arrived && light == ExposureState::well_exposed;
    // Damaged images never became a frame. They arrived between the previous frame and this frame.
    const int bad_now = frame_status.damaged + (good ? 0 : 1);
    if (bad_now > 0) {
        bad_ += bad_now;
        fresh_ = 0;
        if (bad_ >= kBadFrames) {
            state_ = frame_status.repeated > 0              ? CameraState::frozen
                     : !arrived || frame_status.damaged > 0 ? CameraState::corrupt
                     : light == ExposureState::dark         ? CameraState::dark
                                                            : CameraState::overexposed;
        }
    }
    if (!good) return state_;
    bad_ = 0;
    ++fresh_;
    if (state_ == CameraState::unknown || fresh_ >= kFreshFrames) state_ = CameraState::ok;
    return state_;
}

}  // namespace surefoot::pipeline
