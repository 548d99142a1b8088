// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/camera/stereo_rig.hpp"

namespace surefoot::calibration {

/// Measurements of a board of known size with a stereo rig. The points that both images show are
/// triangulated from their columns in the rectified images, as `surefoot run` does. Do not use
/// images from which the rig was calibrated: a wrong square size then changes rig and board alike
/// and stays hidden.
struct BoardMeasures {
    int points = 0;           ///< points that both cameras see
    int lengths = 0;          ///< number of distances between neighbours of a row or a column
    double distance_m = 0.0;  ///< mean depth from the board size, in the rectified left frame
    /// Mean of triangulated depth minus depth from the board size in the left image. Compares
    /// baseline and rotation of the right camera with focal length and square size.
    double axial_m = 0.0;
    double axial_std_m = 0.0;    ///< standard deviation of the depths from their plane
    double lateral_m = 0.0;      ///< mean triangulated minus true distance of neighbours
    double lateral_std_m = 0.0;  ///< standard deviation of these differences
};

/// Returns nullopt without a right camera, with fewer than eight common points, if the points give
/// no board pose, or for views of discs. Both views must have no view_problem().
[[nodiscard]] std::optional<BoardMeasures> measure_board(const Board& board,
                                                         const BoardView& left,
                                                         const BoardView& right,
                                                         const camera::StereoRig& rig);

}  // namespace surefoot::calibration
