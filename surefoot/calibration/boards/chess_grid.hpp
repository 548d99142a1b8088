// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/calibration/boards/chess_corners.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::calibration {

/// What growing a chessboard out of single corners gave.
struct GrownChessboard {
    /// All points of the board in an order along its rows and columns, roughly; those that do not
    /// show lie where their neighbours expect them. Empty when no such board was found.
    std::vector<Eigen::Vector2d> points;
    std::string problem;  ///< what was found instead, where that is worth a word
};

/// Joins corners whose edges lead to each other and whose black squares alternate, and looks for
/// the corners of `board` among them; what is missing is looked for in `image` where neighbours
/// expect it. No model of the lens is needed: only that neighbouring squares look alike.
///
/// Of several such boards the one that fills the largest part of the image counts: the others may
/// be seen in mirrors or on screens. A board that is not seen whole is not found: nobody could
/// number its points. Neither is a part of a larger one.
[[nodiscard]] GrownChessboard grown_chessboard(const Board& board,
                                               std::span<const ChessCorner> corners,
                                               ImageView<const std::uint8_t> image);

}  // namespace surefoot::calibration
