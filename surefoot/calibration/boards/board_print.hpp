// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/core/printed_sheet.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::calibration {

/// Black shapes of a printed board, in the board's frame. Squares: the top left square and the
/// one between the first four points are black. ChArUco: a marker in the middle of each white
/// square, numbered row by row (OpenCV since 4.6). Circles: `circle_share` is their diameter
/// divided by the distance of nearest neighbours. An error if the board is invalid (sizes,
/// dictionary).
[[nodiscard]] Result<PrintedSheet> print_of(const Board& board, double circle_share = 0.5);

}  // namespace surefoot::calibration
