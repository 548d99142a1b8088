// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/sim/rendering/renderer.hpp"
#include "surefoot/sim/sensors/camera_profile.hpp"

namespace surefoot::sim {

/// A flat textured board across the optical axis of the left camera, as in tests of depth cameras,
/// with a wall 1.5 m behind it.
struct BoardView {
    double distance_m = 1.0;  ///< distance from the centre of the left camera
    double side_m = 0.6;      ///< side of the square board, whose middle is on the axis
    CameraProfile profile = CameraProfile::ideal;
    double noise = 1.0;     ///< factor on the noise of the images
    double contrast = 1.0;  ///< factor on the contrast of the materials
    CameraConfig camera;
    CalibrationError calibration_error;
    std::uint64_t seed = 1;  ///< seed of texture and noise
};

struct SeenBoard {
    StereoFrame frame;
    /// Exact disparity of the board and the wall for the rectified left camera.
    Image<float> disparity_px;
};

/// Returns an error if the rig is unusable. `rectified` is the rectified model of the rig.
[[nodiscard]] Result<SeenBoard> see_board(const BoardView& view,
                                          const camera::StereoRig& rig,
                                          const camera::RectifiedRig& rectified,
                                          Executor& executor);

}  // namespace surefoot::sim
