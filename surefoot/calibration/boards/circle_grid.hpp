// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"

namespace surefoot::calibration {

/// Which spots are the circles of a grid: grown from the middle, neighbour by neighbour, each step
/// predicted from the one before, so that lenses may bend the grid. The spots in the order of
/// Board::points_m up to a turn or a mirror image of the board; nothing where they do not form it.
[[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> grown_grid(
    const Board& board, const std::vector<Eigen::Vector2d>& spots);

}  // namespace surefoot::calibration
