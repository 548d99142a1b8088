// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/camera_state.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/pipeline/exposure_state.hpp"

namespace surefoot::pipeline {

/// Derives the state of the camera from its frames. A bad state starts after kBadFrames bad images
/// and ends only after kFreshFrames good frames. One bad image starts no bad state. This monitor
/// runs only when a frame arrives. If no frame arrives, the gate detects the fault by the age of
/// the last frame.
class CameraMonitor {
  public:
    /// Number of consecutive bad images that start a bad state. A bad image is repeated, damaged,
    /// too bright or too dark. Hazard H1 requires two.
    static constexpr int kBadFrames = 2;
    /// Number of consecutive new, whole and well-exposed images that end a bad state. ASSUMPTION:
    /// three, which is 200 ms at 15 Hz. The gate accepts an old frame for the same time.
    static constexpr int kFreshFrames = 3;

    /// Takes the frames in order of arrival. Returns the state after this frame.
    CameraState add(const FrameStatus& frame_status,
                    ExposureState light = ExposureState::well_exposed) noexcept;
    [[nodiscard]] CameraState state() const noexcept { return state_; }

  private:
    CameraState state_ = CameraState::unknown;
    int bad_ = 0;    ///< number of consecutive bad images
    int fresh_ = 0;  ///< number of consecutive good frames
};

}  // namespace surefoot::pipeline
