// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "surefoot/core/views.hpp"

namespace surefoot::calibration {

/// A place where two black and two white squares seem to meet, to about half a pixel.
struct ChessCorner {
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    /// Unit vectors along the four edges, each the next one turned onwards (x right, y down). The
    /// squares between edges 0 and 1 and between 2 and 3 are the black ones.
    std::array<Eigen::Vector2d, 4> edges;
    double contrast_dn = 0.0;  ///< white less black, blurred as the image is
};

/// Single corners of a chessboard, the clearest first. A corner is a saddle point of the blurred
/// image whose surrounding circle changes between black and white exactly four times, at places
/// that lie opposite each other. Nothing is assumed about the lens, about other corners, or about
/// the brightness of the image: only the contrast beside its own noise counts.
///
/// Squares must be about 4 px wide or wider; boards that are less sharp than a blur of 2 px are
/// found in a reduced image. Contrasts below 5 grey values do not count.
[[nodiscard]] std::vector<ChessCorner> chess_corners(ImageView<const std::uint8_t> image);

}  // namespace surefoot::calibration
