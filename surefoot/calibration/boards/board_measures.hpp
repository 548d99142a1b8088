// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/camera/stereo_rig.hpp"

namespace surefoot::calibration {

/// Measures a board of known size with a stereo rig. Triangulates the points that both images
/// show, as `run` does, from columns of the rectified images. Do not use images from which
/// the rig was calibrated: a wrong square size then changes rig and board alike and stays
/// hidden.
struct BoardMeasures {
    int points = 0;           ///< points that both cameras see
    int lengths = 0;          ///< number of distances between neighbours of a row or a column
    double distance_m = 0.0;  ///< mean depth from the board size, in the rectified left frame
    /// Mean difference between the triangulated depth and the depth from the board size in the left
    /// image. Compares baseline and rotation of the right camera with focal length and square size.
    double axial_m = 0.0;
    double axial_std_m = 0.0;    ///< scatter of the triangulated depths around their plane
    double lateral_m = 0.0;      ///< mean triangulated minus true distance of neighbours
    double lateral_std_m = 0.0;  ///< scatter of the single distances
};

/// Returns nullopt for fewer than eight common points, for points that no plane explains, or for
/// views of discs: images do not show disc centres. Both views must have no view_problem().
[[nodiscard]] std::optional<BoardMeasures> measure_board(const Board& board,
                                                         const BoardView& left,
                                                         const BoardView& right,
                                                         const camera::StereoRig& rig);

}  // namespace surefoot::calibration
