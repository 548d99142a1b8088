// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/camera_monitor.hpp"

namespace surefoot::pipeline {

CameraState CameraMonitor::add(const FrameArrival& arrival) noexcept {
    const bool good = arrival.is_new_and_whole();
    // Damaged images never became a frame: they lie between the previous one and this one.
    const int bad_now = arrival.damaged + (good ? 0 : 1);
    if (bad_now > 0) {
        bad_ += bad_now;
        fresh_ = 0;
        if (bad_ >= kBadFrames)
            state_ = arrival.repeated > 0 ? CameraState::frozen : CameraState::corrupt;
    }
    if (!good) return state_;
    bad_ = 0;
    ++fresh_;
    if (state_ == CameraState::unknown || fresh_ >= kFreshFrames) state_ = CameraState::ok;
    return state_;
}

}  // namespace surefoot::pipeline
