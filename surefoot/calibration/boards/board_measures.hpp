// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/camera/stereo_rig.hpp"

namespace surefoot::calibration {

/// A board of known size as a stereo rig measures it: the points that both images show are
/// triangulated as `run` does, from columns of the rectified images. Means nothing of a pair by
/// which the rig was calibrated; a wrong size of the squares goes into rig and board alike and does
/// not show.
struct BoardMeasures {
    int points = 0;           ///< seen by both eyes
    int lengths = 0;          ///< between neighbours of a row or a column
    double distance_m = 0.0;  ///< mean depth of the points in the rectified left frame, by size
    /// Triangulated depth less the one that the board's size says in the left image alone, mean of
    /// the points: baseline and turn of the right eye against focal length and squares.
    double axial_m = 0.0;
    double axial_std_m = 0.0;    ///< of the triangulated depths about their plane
    double lateral_m = 0.0;      ///< triangulated length between neighbours less the true, mean
    double lateral_std_m = 0.0;  ///< of single lengths
};

/// Nothing for fewer than eight points in common, points that no plane explains, or views of discs,
/// whose centres the images do not show. Both views must have no view_problem().
[[nodiscard]] std::optional<BoardMeasures> measure_board(const Board& board,
                                                         const BoardView& left,
                                                         const BoardView& right,
                                                         const camera::StereoRig& rig);

}  // namespace surefoot::calibration
