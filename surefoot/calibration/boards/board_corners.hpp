// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::calibration {

/// Corners of a chessboard to sub-pixels (`fit_corner`), from where they roughly lie: neighbours on
/// the board tell the directions, lengths and bends of its lines. What has no neighbour in its row
/// or in its column, or does not look like a corner, leaves the view.
void fit_corners(const Board& board, ImageView<const std::uint8_t> image, BoardView& view);

}  // namespace surefoot::calibration
