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

/// Result of growing a chessboard from single corners.
struct GrownChessboard {
    /// Rough positions of all points of the board [px], in order along rows and columns. Hidden
    /// points lie where their neighbours predict them. Empty if the board was not found.
    std::vector<Eigen::Vector2d> points;
    std::string problem;  ///< description of a board that does not match; may be empty
};

/// Joins corners whose edges lead to each other and whose black squares alternate, and finds the
/// corners of `board` among them. Searches `image` for missing corners where neighbours predict
/// them. Needs no lens model; neighbouring squares only have to look similar.
///
/// Of several such boards, returns the board that fills the largest part of the image: others may
/// be reflections or pictures on screens. Each outer row and column must be at least half visible,
/// and the board must not be part of a larger board: otherwise the ids would be uncertain.
[[nodiscard]] GrownChessboard grown_chessboard(const Board& board,
                                               std::span<const ChessCorner> corners,
                                               ImageView<const std::uint8_t> image);

}  // namespace surefoot::calibration
