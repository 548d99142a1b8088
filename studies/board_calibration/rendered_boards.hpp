// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/rng.hpp"

// Poses of calibration boards for rendered images with known truth.
namespace surefoot::app {

/// A camera and its pose in the frame of the left camera.
struct BoardCamera {
    camera::Camera camera;
    Pose T_left_camera;
};
[[nodiscard]] std::vector<BoardCamera> cameras_of(const camera::StereoRig& rig);

/// Returns `count` poses of the board in the left optical frame, as a careful operator shows it.
/// All cameras see the whole board. Some poses are near, others far. The tilt about each axis is at
/// most 40 deg. Returns fewer poses if too few positions fit into all images.
[[nodiscard]] std::vector<Pose> shown_poses(const calibration::Board& board,
                                            std::span<const BoardCamera> cameras,
                                            int count,
                                            Rng& rng);

}  // namespace surefoot::app
