// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/core/printed_sheet.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::calibration {

/// What is black on a printed board, in the board's frame.
/// Squares: the one at the top left is black, so is the one between the first four points. ChArUco:
/// a marker in the middle of each white square, numbered row by row (OpenCV since 4.6). Circles:
/// `circle_share` is their diameter over the distance of the nearest neighbour. Fails with the
/// reason why there is no such board (sizes, dictionary).
[[nodiscard]] Result<PrintedSheet> print_of(const Board& board, double circle_share = 0.5);

}  // namespace surefoot::calibration
