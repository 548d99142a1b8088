// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"

namespace surefoot::calibration {

/// Selects the spots that form a circle grid. Grows from the middle; each step is predicted from
/// the previous one, so the lens may bend the grid. Returns the order of Board::points_m, up to a
/// rotation or mirror image of the board; nullopt if the spots do not form it.
[[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> grown_grid(
    const Board& board, const std::vector<Eigen::Vector2d>& spots);

}  // namespace surefoot::calibration
