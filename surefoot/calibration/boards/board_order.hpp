// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::calibration {

/// The pixel as a smooth function of the board position x around one point, to second order: pixel
/// = centre + J x + (x' H_u x, x' H_v x) / 2.
struct LocalMap {
    Eigen::Vector2d pixel;
    Eigen::Matrix2d J_px_m;
    Eigen::Matrix2d H_u;
    Eigen::Matrix2d H_v;
    double rms_px = 0.0;  ///< rms error of the fitted points
};

/// Least squares over pairs of board position relative to the expansion point [m] and pixel.
/// nullopt unless at least six pairs determine the map.
[[nodiscard]] std::optional<LocalMap> fit_local_map(const std::vector<Eigen::Vector2d>& places_m,
                                                    const std::vector<Eigen::Vector2d>& pixels);

/// Points of a whole grid, sorted from any order along rows and columns into the order of
/// Board::points_m that detect_board promises. nullopt if they do not look like the board.
[[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> ordered_points(
    const Board& board,
    const std::vector<Eigen::Vector2d>& found,
    ImageView<const std::uint8_t> image);

}  // namespace surefoot::calibration
