// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/calibration/board.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::calibration {

/// Images of the centres of the circles of a grid, from rough ones: centre of gravity of the dark
/// ink around each, less what perspective and lens move it away from the image of the centre. The
/// radius of the circles is measured too, the board does not name it. Where a circle has too little
/// contrast its rough centre stays.
[[nodiscard]] std::vector<Eigen::Vector2d> refined_circle_centres(
    const Board& board,
    const std::vector<Eigen::Vector2d>& rough,
    ImageView<const std::uint8_t> image);

}  // namespace surefoot::calibration
