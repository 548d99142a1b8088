// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::calibration {

/// The circles of a grid as seen in one image.
struct DiscImages {
    std::vector<Eigen::Vector2d> centroids;  ///< centres of gravity of the dark areas [px]
    /// Radius of the circles on the board, measured from their area. Board does not contain it.
    double radius_m = 0.0;
};

/// Measures the common radius and the centres of gravity (not the images of the centres: see
/// disc_image.hpp), from rough centres. A circle with low contrast keeps its rough centre.
[[nodiscard]] DiscImages measured_discs(const Board& board,
                                        const std::vector<Eigen::Vector2d>& rough,
                                        ImageView<const std::uint8_t> image);

}  // namespace surefoot::calibration
