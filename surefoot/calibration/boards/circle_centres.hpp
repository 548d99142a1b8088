// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::calibration {

/// The circles of a grid as an image shows them.
struct DiscImages {
    std::vector<Eigen::Vector2d> centroids;  ///< centres of gravity of their ink [px]
    /// Of the circles on the board, from the area of their ink: the board does not name it.
    double radius_m = 0.0;
};

/// Centres of gravity and common radius from rough centres. Where a circle has too little contrast
/// its rough centre stays. A centre of gravity is not the image of the centre (see disc_image.hpp).
[[nodiscard]] DiscImages measured_discs(const Board& board,
                                        const std::vector<Eigen::Vector2d>& rough,
                                        ImageView<const std::uint8_t> image);

}  // namespace surefoot::calibration
