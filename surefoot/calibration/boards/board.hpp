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

/// A flat calibration target. Its points lie in its plane z = 0: x along a row, y from row to row,
/// z away from the viewer. The first point is the origin.
struct Board {
    BoardKind kind = BoardKind::chessboard;
    /// Points per row, and number of rows. Points: inner corners of a chessboard or ChArUco board
    /// (squares - 1), or circles. Asymmetric circles: every second row shifts by half the spacing.
    int columns = 9;
    int rows = 6;
    /// Distance between neighbours in a row [m]: side of a square, or distance of circles. Rows of
    /// asymmetric circles are half this distance apart.
    double spacing_m = 0.025;
    double marker_m = 0.018;                 ///< ChArUco: side of a marker [m]
    std::string dictionary = "DICT_4X4_50";  ///< ChArUco: OpenCV's name of the marker set

    /// Describes the first problem of the board, for example its size; nullopt if it has none.
    [[nodiscard]] std::optional<std::string> problem() const;
    /// Point positions [m], index = row * columns + column.
    [[nodiscard]] std::vector<Eigen::Vector3d> points_m() const;
};

/// Reads "chessboard:9x6:0.025", "circles:6x6:0.02", "asymmetric_circles:4x11:0.04" or
/// "charuco:8x5:0.03:0.022[:DICT_5X5_100]". Shops and OpenCV count the squares of a ChArUco board:
/// "charuco:8x5squares:..." and "chessboard:10x7squares:..." mean 7 x 4 and 9 x 6 inner corners.
/// Returns nullopt for any other text. Does not check sizes: see problem().
[[nodiscard]] std::optional<Board> parse_board(const std::string& text);
/// Returns the size for the user: "8 x 5 squares = 7 x 4 inner corners", or "6 x 6 circles".
[[nodiscard]] std::string size_in_words(const Board& board);

/// Points of a board in one image.
struct BoardView {
    std::vector<int> ids;                 ///< index into Board::points_m, ascending
    std::vector<Eigen::Vector2d> pixels;  ///< [px], one per id; (0, 0) = centre of the first pixel
    /// If 0, the pixels are images of points. Otherwise the points are discs of this radius, and
    /// the pixels are the centres of gravity of their images (not the images of their centres).
    double disc_radius_m = 0.0;
    friend bool operator==(const BoardView&, const BoardView&) = default;
};

}  // namespace surefoot::calibration
