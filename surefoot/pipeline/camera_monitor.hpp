// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/camera_state.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/pipeline/exposure_state.hpp"

namespace surefoot::pipeline {

/// Turns how frames come in into a state of the camera: inhibits at once, releases slowly. A single
/// bad frame is left out and changes nothing; what ages meanwhile is seen by its stamp. A camera
/// that sends nothing at all is seen by the age of its last frame, too: nobody calls a monitor
/// then.
class CameraMonitor {
  public:
    /// Images in a row that bring nothing new, nothing whole or nothing to see: two, as hazard H1
    /// says.
    static constexpr int kBadFrames = 2;
    /// New, whole and lit images in a row that end it. ASSUMPTION: three, 200 ms at 15 Hz, as long
    /// as the gate believes an old frame.
    static constexpr int kFreshFrames = 3;

    /// Frames in the order in which they came; returns the state after this one.
    CameraState add(const FrameStatus& frame_status,
                    ExposureState light = ExposureState::well_exposed) noexcept;
    [[nodiscard]] CameraState state() const noexcept { return state_; }

  private:
    CameraState state_ = CameraState::unknown;
    int bad_ = 0;    ///< in a row
    int fresh_ = 0;  ///< in a row
};

}  // namespace surefoot::pipeline
