// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/boards/chess_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "surefoot/calibration/boards/chess_lattice.hpp"

namespace surefoot::calibration {
namespace {

/// Least share of the board's points that the lattice must contain.
constexpr double kLeastShare = 0.75;
/// Least filled share of each border line: without border corners the position of the board is
/// ambiguous.
constexpr double kLeastOfBorder = 0.5;

/// Smallest group of corners from which a board can grow.
constexpr std::size_t kFewestJoined = 9;

/// A rectangle of nodes that may be the board, with `columns` nodes along the first axis.
struct Window {
    Node low;
    int columns = 0;
    int rows = 0;
    int corners = 0;
};

int corners_in(const Lattice& lattice, const Node& low, int columns, int rows) {
    int corners = 0;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column)
            corners += lattice.contains({low.first + column, low.second + row}) ? 1 : 0;
    return corners;
}

/// The four border lines of a window, one node wide: just outside (`outside`) or just inside.
std::array<Window, 4> borders_of(const Window& w, bool outside) {
    const int out = outside ? 1 : 0;
    const auto [x, y] = w.low;
    return {{{{x - out, y}, 1, w.rows, 0},
             {{x + w.columns - 1 + out, y}, 1, w.rows, 0},
             {{x, y - out}, w.columns, 1, 0},
             {{x, y + w.rows - 1 + out}, w.columns, 1, 0}}};
}

/// Returns the smallest and the largest filled share of the four border lines.
std::pair<double, double> border_shares(const Lattice& lattice, const Window& w, bool outside) {
    double least = 1.0;
    double most = 0.0;
    for (const Window& line : borders_of(w, outside)) {
        const double share =
            static_cast<double>(corners_in(lattice, line.low, line.columns, line.rows)) /
            (line.columns * line.rows);
        least = std::min(least, share);
        most = std::max(most, share);
    }
    return {least, most};
}

/// Returns all positions of the board on the lattice, the position with the most corners first.
std::vector<Window> windows_of(const Board& board, const Lattice& lattice) {
    const auto [low, high] = bounds_of(lattice);
    std::vector<Window> windows;
    for (const bool turned : {false, true}) {
        const int columns = turned ? board.rows : board.columns;
        const int rows = turned ? board.columns : board.rows;
        if (turned && columns == rows) break;
        for (int y = low.second - rows + 1; y <= high.second; ++y)
            for (int x = low.first - columns + 1; x <= high.first; ++x)
                windows.push_back({{x, y}, columns, rows, 0});
    }
    for (Window& w : windows) w.corners = corners_in(lattice, w.low, w.columns, w.rows);
    std::stable_sort(windows.begin(), windows.end(), [](const Window& a, const Window& b) {
        return a.corners > b.corners;
    });
    return windows;
}

std::vector<Eigen::Vector2d> points_of(const Board& board, const Lattice& lattice, Window window) {
    std::vector<Eigen::Vector2d> points;
    Lattice whole;  // omits corners outside the window: they belong to another object
    for (const auto& [node, pixel] : lattice)
        if (corners_in({{node, pixel}}, window.low, window.columns, window.rows) > 0)
            whole.emplace(node, pixel);
    while (corners_in(whole, window.low, window.columns, window.rows) <
           window.columns * window.rows) {
        Lattice more = whole;
        for (int row = 0; row < window.rows; ++row) {
            for (int column = 0; column < window.columns; ++column) {
                const Node node{window.low.first + column, window.low.second + row};
                if (whole.contains(node)) continue;
                if (const auto place = expected_place(whole, node)) more.emplace(node, *place);
            }
        }
        if (more.size() == whole.size()) return {};
        whole = std::move(more);
    }
    for (int row = 0; row < board.rows; ++row) {
        for (int column = 0; column < board.columns; ++column) {
            const bool turned = window.columns != board.columns;
            const Node node{window.low.first + (turned ? row : column),
                            window.low.second + (turned ? column : row)};
            points.push_back(whole.at(node));
        }
    }
    return points;
}

GrownChessboard board_in(const Board& board, const Lattice& lattice) {
    GrownChessboard grown;
    const std::vector<Window> windows = windows_of(board, lattice);
    const Window& best = windows.front();
    const int wanted = board.columns * board.rows;
    if (best.corners < kLeastShare * wanted) return grown;
    const auto [low, high] = bounds_of(lattice);
    const auto size_text =
        fmt::format("{} x {}", high.first - low.first + 1, high.second - low.second + 1);
    const bool larger = border_shares(lattice, best, true).second > kLeastOfBorder;
    if (larger) {
        grown.problem = fmt::format(
            "the chessboard in the image has at least {} inner corners, more than the {} x {} of "
            "the given board; give the size of the board in the image",
            size_text,
            board.columns,
            board.rows);
    } else if (border_shares(lattice, best, false).first < kLeastOfBorder ||
               (windows.size() > 1 && windows[1].corners == best.corners)) {
        grown.problem = fmt::format(
            "the image shows only a part of the chessboard, {} of {} x {} inner corners; show the "
            "whole board",
            size_text,
            board.columns,
            board.rows);
    } else {
        grown.points = points_of(board, lattice, best);
    }
    return grown;
}

/// Returns the area of the bounding box of points in the image [px^2].
double area_of(const std::vector<Eigen::Vector2d>& points) {
    if (points.empty()) return 0.0;
    Eigen::Vector2d low = points.front();
    Eigen::Vector2d high = low;
    for (const Eigen::Vector2d& point : points) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    return (high - low).prod();
}

}  // namespace

GrownChessboard grown_chessboard(const Board& board,
                                 std::span<const ChessCorner> corners,
                                 ImageView<const std::uint8_t> image) {
    GrownChessboard best;
    double best_area_px2 = 0.0;
    for (const JoinedCorners& joined : joined_corners(corners, image)) {
        // The groups are sorted by size, so all later groups are too small too. If the corners of a
        // board fall into several groups, the largest group still has several squares.
        if (joined.lattice.size() < kFewestJoined) break;
        const int most = std::max(board.columns, board.rows) + 2;
        const Lattice lattice = grown_lattice(joined, corners, image, most);
        GrownChessboard grown = board_in(board, lattice);
        const double area_px2 = area_of(grown.points);
        if (area_px2 > best_area_px2 || (best.points.empty() && best.problem.empty()))
            best = std::move(grown);
        best_area_px2 = std::max(best_area_px2, area_px2);
    }
    return best;
}

}  // namespace surefoot::calibration
