// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/boards/board_print.hpp"

#include <algorithm>
#include <numbers>

#include "surefoot/calibration/boards/charuco.hpp"

namespace surefoot::calibration {
namespace {

void add_squares(const Board& board, PrintedSheet& print) {
    const double side_m = board.spacing_m;
    for (int row = 0; row < squares(board.rows); ++row) {
        for (int column = row % 2; column < squares(board.columns); column += 2) {
            const double left_m = (column - 1) * side_m;  // the first corner is the origin
            const double top_m = (row - 1) * side_m;
            print.rectangles.push_back({left_m, top_m, left_m + side_m, top_m + side_m});
        }
    }
}

/// Adds a marker to the sheet: a black frame of one bit width around the bits. A bit of value 0 is
/// black.
void add_marker(const cv::aruco::Dictionary& dictionary,
                int id,
                double left_m,
                double top_m,
                double side_m,
                PrintedSheet& print) {
    const int inner = dictionary.markerSize;
    const int all = inner + 2;
    const cv::Mat bits = cv::aruco::Dictionary::getBitsFromByteList(
        dictionary.bytesList.rowRange(id, id + 1), inner);
    const double bit_m = side_m / all;
    for (int row = 0; row < all; ++row) {
        for (int column = 0; column < all; ++column) {
            const bool frame = row == 0 || column == 0 || row == all - 1 || column == all - 1;
            if (!frame && bits.at<std::uint8_t>(row - 1, column - 1) != 0) continue;
            const double x_m = left_m + column * bit_m;
            const double y_m = top_m + row * bit_m;
            print.rectangles.push_back({x_m, y_m, x_m + bit_m, y_m + bit_m});
        }
    }
}

void add_markers(const Board& board, const cv::aruco::Dictionary& dictionary, PrintedSheet& print) {
    const double margin_m = 0.5 * (board.spacing_m - board.marker_m);
    int id = 0;
    for (int row = 0; row < squares(board.rows); ++row) {
        for (int column = 1 - row % 2; column < squares(board.columns); column += 2) {
            add_marker(dictionary,
                       id++,
                       (column - 1) * board.spacing_m + margin_m,
                       (row - 1) * board.spacing_m + margin_m,
                       board.marker_m,
                       print);
        }
    }
}

void add_circles(const Board& board, double circle_share, PrintedSheet& print) {
    const bool staggered = board.kind == BoardKind::asymmetric_circles;
    const double nearest_m = staggered ? board.spacing_m / std::numbers::sqrt2 : board.spacing_m;
    for (const Eigen::Vector3d& point_m : board.points_m())
        print.discs.push_back({point_m.x(), point_m.y(), 0.5 * circle_share * nearest_m});
}

}  // namespace

Result<PrintedSheet> print_of(const Board& board, double circle_share) {
    if (const auto problem = board.problem()) return usage_error(*problem);
    PrintedSheet print;
    const bool has_squares =
        board.kind == BoardKind::chessboard || board.kind == BoardKind::charuco;
    if (has_squares) {
        add_squares(board, print);
    } else {
        add_circles(board, circle_share, print);
    }
    if (board.kind == BoardKind::charuco) {
        const auto dictionary = dictionary_of(board);
        if (!dictionary) return dictionary.error();
        add_markers(board, **dictionary, print);
    }
    const Eigen::Vector3d last_m = board.points_m().back();
    const double margin_m = (has_squares ? 2.0 : 1.0) * board.spacing_m;
    const double staggered_m =
        board.kind == BoardKind::asymmetric_circles ? 0.5 * board.spacing_m : 0.0;
    print.paper = {
        -margin_m, -margin_m, last_m.x() + staggered_m + margin_m, last_m.y() + margin_m};
    return print;
}

}  // namespace surefoot::calibration
