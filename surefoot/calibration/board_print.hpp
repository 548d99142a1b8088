// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/calibration/board.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::calibration {

/// What is black on a printed board, in the board's frame [m]: to draw it, or to render it.
struct BoardPrint {
    struct Rectangle {
        double left_m = 0.0;
        double top_m = 0.0;
        double right_m = 0.0;
        double bottom_m = 0.0;
    };
    struct Disc {
        double x_m = 0.0;
        double y_m = 0.0;
        double radius_m = 0.0;
    };
    Rectangle paper;  ///< with a white margin
    std::vector<Rectangle> rectangles;
    std::vector<Disc> discs;
};

/// Squares: the one at the top left is black, so is the one between the first four points. ChArUco:
/// a marker in the middle of each white square, numbered row by row (OpenCV since 4.6). Circles:
/// `circle_share` is their diameter over the distance of the nearest neighbour. Fails with the
/// reason why there is no such board (sizes, dictionary).
[[nodiscard]] Result<BoardPrint> print_of(const Board& board, double circle_share = 0.5);

}  // namespace surefoot::calibration
