// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/boards/board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <string_view>

namespace surefoot::calibration {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    std::size_t begin = 0;
    while (true) {
        const std::size_t end = text.find(separator, begin);
        parts.push_back(text.substr(begin, end - begin));
        if (end == std::string::npos) return parts;
        begin = end + 1;
    }
}

template <typename Number>
bool read(const std::string& text, Number& value) {
    const char* const end = text.data() + text.size();
    const auto result = std::from_chars(text.data(), end, value);
    return result.ec == std::errc{} && result.ptr == end;
}

}  // namespace

std::optional<std::string> Board::problem() const {
    constexpr int kLeast = 3;
    constexpr int kMost = 200;
    if (columns < kLeast || rows < kLeast || columns > kMost || rows > kMost) {
        return fmt::format("board: {} x {} points; give {} to {} points on each side",
                           columns,
                           rows,
                           kLeast,
                           kMost);
    }
    if (!(spacing_m > 0.0 && spacing_m <= 10.0))
        return fmt::format("board: the point spacing of {} m must be above 0 and at most 10 m",
                           spacing_m);
    if (kind == BoardKind::charuco && !(marker_m > 0.0 && marker_m < spacing_m)) {
        return fmt::format(
            "board: markers of {} m must be larger than 0 and smaller than the squares of {} m",
            marker_m,
            spacing_m);
    }
    return std::nullopt;
}

std::vector<Eigen::Vector3d> Board::points_m() const {
    const bool staggered = kind == BoardKind::asymmetric_circles;
    std::vector<Eigen::Vector3d> points;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const double shift = staggered && row % 2 == 1 ? 0.5 : 0.0;
            const double down = staggered ? 0.5 * row : row;
            points.emplace_back(spacing_m * (column + shift), spacing_m * down, 0.0);
        }
    }
    return points;
}

namespace {

bool has_squares(BoardKind kind) {
    return kind == BoardKind::chessboard || kind == BoardKind::charuco;
}

/// Reads a size: "8x5" (points) or "8x5squares". A board of 8 x 5 squares has 7 x 4 points. Returns
/// false for any other text.
bool read_size(std::string text, Board& board) {
    constexpr std::string_view kSquares = "squares";
    const bool squares = text.ends_with(kSquares);
    if (squares) text.resize(text.size() - kSquares.size());
    const std::vector<std::string> size = split(text, 'x');
    if (size.size() != 2 || !read(size[0], board.columns) || !read(size[1], board.rows))
        return false;
    if (!squares) return true;
    constexpr int kMost = 1'000'000;  // problem() checks the final limits
    if (board.columns < 1 || board.rows < 1 || board.columns > kMost || board.rows > kMost)
        return false;
    --board.columns;
    --board.rows;
    return has_squares(board.kind);
}

}  // namespace

std::string size_in_words(const Board& board) {
    if (!has_squares(board.kind)) return fmt::format("{} x {} circles", board.columns, board.rows);
    return fmt::format("{} x {} squares = {} x {} inner corners",
                       board.columns + 1,
                       board.rows + 1,
                       board.columns,
                       board.rows);
}

std::optional<Board> parse_board(const std::string& text) {
    const std::vector<std::string> parts = split(text, ':');
    const auto kind =
        std::find(std::begin(kBoardKindNames), std::end(kBoardKindNames), parts.front());
    if (parts.size() < 3 || kind == std::end(kBoardKindNames)) return std::nullopt;
    Board board;
    board.kind = static_cast<BoardKind>(kind - std::begin(kBoardKindNames));
    if (!read_size(parts[1], board) || !read(parts[2], board.spacing_m)) return std::nullopt;
    if (board.kind != BoardKind::charuco)
        return parts.size() == 3 ? std::optional<Board>(board) : std::nullopt;
    if (parts.size() < 4 || parts.size() > 5 || !read(parts[3], board.marker_m))
        return std::nullopt;
    if (parts.size() == 5) board.dictionary = parts[4];
    return board;
}

}  // namespace surefoot::calibration
