// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::calibration {

/// Second-order model of the pixel as a function of x, the board position relative to one point:
/// `pixel` + J_px_m x + (x' H_u x, x' H_v x) / 2.
struct LocalMap {
    Eigen::Vector2d pixel;
    Eigen::Matrix2d J_px_m;
    Eigen::Matrix2d H_u;
    Eigen::Matrix2d H_v;
    double rms_px = 0.0;  ///< rms error of the fitted points
};

/// Fits the map by least squares to pairs of board position, relative to the expansion point [m],
/// and pixel. Returns nullopt unless at least six pairs determine the map.
[[nodiscard]] std::optional<LocalMap> fit_local_map(const std::vector<Eigen::Vector2d>& places_m,
                                                    const std::vector<Eigen::Vector2d>& pixels);

/// Brings all points of a grid into the order that detect_board promises. `found` lists them line
/// by line, from any corner of the grid. Returns nullopt if no order looks like the board.
[[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> ordered_points(
    const Board& board,
    const std::vector<Eigen::Vector2d>& found,
    ImageView<const std::uint8_t> image);

}  // namespace surefoot::calibration
