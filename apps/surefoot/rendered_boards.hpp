// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/rng.hpp"

// Poses for pictures of boards whose truth is known.
namespace surefoot::app {

/// A camera with its place in the frame of the left one.
struct BoardEye {
    camera::Camera camera;
    Pose T_left_eye;
};
[[nodiscard]] std::vector<BoardEye> eyes_of(const camera::StereoRig& rig);

/// `count` poses of the board in the left optical frame, as a careful operator shows it: wherever
/// all eyes see it whole, near and far, turned by up to 40 deg each way. Fewer where the board does
/// not find room.
[[nodiscard]] std::vector<Pose> shown_poses(const calibration::Board& board,
                                            std::span<const BoardEye> eyes,
                                            int count,
                                            Rng& rng);

}  // namespace surefoot::app
