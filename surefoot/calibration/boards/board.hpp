// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace surefoot::calibration {

enum class BoardKind : std::uint8_t { chessboard, circles, asymmetric_circles, charuco };
inline constexpr const char* kBoardKindNames[] = {
    "chessboard", "circles", "asymmetric_circles", "charuco"};

/// A flat calibration target. Its points lie in its plane z = 0 (x along a row, y from row to row,
/// z away from the viewer), the first one at the origin.
struct Board {
    BoardKind kind = BoardKind::chessboard;
    /// Points of a row and rows: inner corners of a chessboard or of a ChArUco board (squares - 1),
    /// circles of a grid. Asymmetric circles: every second row is shifted by half a step.
    int columns = 9;
    int rows = 6;
    /// Between neighbours of a row [m]: side of a square, distance of circles. Rows of asymmetric
    /// circles are half of it apart.
    double spacing_m = 0.025;
    double marker_m = 0.018;                 ///< ChArUco: side of a marker
    std::string dictionary = "DICT_4X4_50";  ///< ChArUco: as OpenCV names it

    /// First reason why there can be no such board.
    [[nodiscard]] std::optional<std::string> problem() const;
    /// [m], index = row * columns + column.
    [[nodiscard]] std::vector<Eigen::Vector3d> points_m() const;
};

/// "chessboard:9x6:0.025", "circles:6x6:0.02", "asymmetric_circles:4x11:0.04" or
/// "charuco:8x5:0.03:0.022[:DICT_5X5_100]". Shops and OpenCV count the squares of a ChArUco board:
/// "charuco:8x5squares:..." and "chessboard:10x7squares:..." are boards of 7 x 4 and 9 x 6 inner
/// corners. Nothing if it cannot be read; see problem() too.
[[nodiscard]] std::optional<Board> parse_board(const std::string& text);
/// "8 x 5 squares = 7 x 4 inner corners", or "6 x 6 circles": what to compare with the board.
[[nodiscard]] std::string size_in_words(const Board& board);

/// Points of a board as one image shows them.
struct BoardView {
    std::vector<int> ids;                 ///< index into Board::points_m, ascending
    std::vector<Eigen::Vector2d> pixels;  ///< one per id; (0, 0) is the centre of the first pixel
    /// 0: the pixels are images of points. Otherwise the points are discs of this radius, and the
    /// pixels are the centres of gravity of their images, beside the images of their centres.
    double disc_radius_m = 0.0;
    friend bool operator==(const BoardView&, const BoardView&) = default;
};

}  // namespace surefoot::calibration
