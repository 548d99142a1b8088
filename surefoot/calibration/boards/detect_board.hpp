// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::calibration {

/// Result of a board detection: the points, or the reason why no points were found.
struct BoardSighting {
    BoardView view;
    std::string problem;  ///< empty if the board was found
    [[nodiscard]] bool found() const noexcept { return problem.empty(); }
};

/// Returns an error if the board cannot be detected: wrong sizes or wrong ChArUco dictionary.
[[nodiscard]] Status check_detectable(const Board& board);

/// Detects the board in an image, to sub-pixel accuracy. Chessboards may lack a few corners, circle
/// grids none; a ChArUco board needs `kFewestCharucoPoints` points, not all on one line.
///
/// Order of the points, seen from the front: x of the board points right and y down. The square
/// between the first four points of a chessboard is black. If a board looks the same after a
/// rotation (see `turns_of`), its rows run to the right in the image. `turned_like` makes the
/// second camera of a pair agree with the first.
///
/// Circles: gives the centre of gravity of each dark area, and the radius from its size. On a near,
/// tilted board the image of a circle's centre lies up to half a pixel beside this centre of
/// gravity. Computing that offset needs the lens model.
inline constexpr int kFewestCharucoPoints = 6;
[[nodiscard]] BoardSighting detect_board(const Board& board, ImageView<const std::uint8_t> image);

/// Returns all renumberings after which the board looks the same, each as new ids of all points.
/// The identity comes first, then valid rotations by a quarter, half and three quarters turn.
[[nodiscard]] std::vector<std::vector<int>> turns_of(const Board& board);

/// Renumbers the view by the one of `turns_of` that makes its rows most parallel to those of
/// `reference`. Valid for the two cameras of a rig if their rotations differ by less than 45 deg.
[[nodiscard]] BoardView turned_like(const Board& board,
                                    const BoardView& reference,
                                    const BoardView& view);

}  // namespace surefoot::calibration
