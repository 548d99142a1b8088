// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "sim/board_renderer.hpp"
#include "surefoot/calibration/board.hpp"
#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/core/rng.hpp"

// Pictures of boards whose truth is known: the simulator draws what the calibration prints.
namespace surefoot::app {

/// The board as the simulator draws it; fails where there is no such board.
[[nodiscard]] Result<sim::PrintedSheet> sheet_of(const calibration::Board& board);

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
