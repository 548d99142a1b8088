// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"

namespace surefoot::calibration {

/// Selects the spots that form a circle grid. The grid grows from the middle and predicts each step
/// from the previous step, so the lens may bend the grid. Returns nullopt without such a grid. The
/// order is that of Board::points_m, up to a rotation or mirror image of the board.
[[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> grown_grid(
    const Board& board, const std::vector<Eigen::Vector2d>& spots);

}  // namespace surefoot::calibration
