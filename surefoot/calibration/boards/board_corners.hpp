// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::calibration {

/// Refines rough corners of a chessboard to sub-pixel accuracy (`fit_corner`). Neighbouring corners
/// give direction, step and curvature of the lines. Removes a point without a neighbour in its row
/// or in its column, and a point whose fit fails or moves too far.
void fit_corners(const Board& board, ImageView<const std::uint8_t> image, BoardView& view);

}  // namespace surefoot::calibration
