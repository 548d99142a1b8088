// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::calibration {

/// What looking for a board in an image gave: its points, or the reason why there are none.
struct BoardSighting {
    BoardView view;
    std::string problem;  ///< empty when found
    [[nodiscard]] bool found() const noexcept { return problem.empty(); }
};

/// Whether boards of this kind can be looked for: sizes, and the dictionary of a ChArUco board.
[[nodiscard]] Status check_detectable(const Board& board);

/// Looks for the board in an image, to sub-pixels. Grids and chessboards must be seen whole;
/// of a ChArUco board `kFewestCharucoPoints` points that do not lie on one line are enough.
///
/// Order of the points: seen from the front, x of the board to the right and y down, turned so that
/// the square between the first four points of a chessboard is black. Boards that look the same
/// after a turn (see `turns_of`) come in the order whose rows run most to the right in the image;
/// `turned_like` makes the second eye of a pair agree with the first.
///
/// Circles: centre of gravity of the ink, with the radius that its area shows. The image of a
/// circle's centre lies up to half a pixel beside it on a tilted board close by; only who knows the
/// lens can say where.
inline constexpr int kFewestCharucoPoints = 6;
[[nodiscard]] BoardSighting detect_board(const Board& board, ImageView<const std::uint8_t> image);

/// Every way to renumber the points of the board so that it looks the same, as the new id of each
/// point: the identity first, then turns by a quarter, half and three quarters where they fit.
[[nodiscard]] std::vector<std::vector<int>> turns_of(const Board& board);

/// The view, renumbered by that turn of the board whose rows run most like those of `reference`:
/// right for the two eyes of a rig, which are not turned by 45 deg against each other.
[[nodiscard]] BoardView turned_like(const Board& board,
                                    const BoardView& reference,
                                    const BoardView& view);

}  // namespace surefoot::calibration
