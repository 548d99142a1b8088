// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "surefoot/core/views.hpp"

namespace surefoot::calibration {

/// A possible meeting point of two black and two white squares, accurate to about half a pixel.
struct ChessCorner {
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    /// Unit vectors along the four edges, in order of rotation from x (right) to y (down). The
    /// squares between edges 0 and 1 and between 2 and 3 are black.
    std::array<Eigen::Vector2d, 4> edges;
    double contrast_dn = 0.0;  ///< white minus black in the blurred image [grey values]
};

/// Returns single corners of a chessboard, highest contrast first. A corner is a saddle point of
/// the blurred image. The circle around it changes between black and white exactly four times, at
/// opposite positions. The detector assumes nothing about the lens, other corners or the
/// brightness.
///
/// Squares must be at least about 4 px wide. If the blur exceeds 2 px, callers search in a reduced
/// image. Contrasts below 5 grey values do not count.
[[nodiscard]] std::vector<ChessCorner> chess_corners(ImageView<const std::uint8_t> image);

}  // namespace surefoot::calibration
