// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/core/printed_sheet.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::calibration {

/// Returns the black shapes of a printed board, in the board's frame. The top left square and the
/// square between the first four points are black. A ChArUco board has a marker in each white
/// square, numbered row by row (OpenCV since 4.6). `circle_share` is the diameter of the circles
/// divided by the distance of nearest neighbours. Returns an error if the board is invalid (sizes,
/// dictionary).
[[nodiscard]] Result<PrintedSheet> print_of(const Board& board, double circle_share = 0.5);

}  // namespace surefoot::calibration
