// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "surefoot/core/views.hpp"

namespace surefoot::calibration {

/// Rough position of a chessboard corner, and the direction of the board's lines there.
struct CornerGuess {
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    Eigen::Vector2d along_row_px = Eigen::Vector2d::Zero();     ///< one square along the row
    Eigen::Vector2d along_column_px = Eigen::Vector2d::Zero();  ///< one square along the column
    /// Curvature of the corner's row and column in the image, positive towards the normal (the
    /// direction rotated by +90 deg; x right, y down). Lenses bend straight lines: in a fisheye
    /// image of f = 240 px by up to 0.05 px in a window of 10 px.
    double row_bend_per_px = 0.0;
    double column_bend_per_px = 0.0;
};

/// Refines a corner to sub-pixel accuracy. The image model consists of two crossing, blurred edges:
///
///     m + h erf(d1 / (sqrt(2) s)) erf(d2 / (sqrt(2) s)).
///
/// d1 and d2 are the distances from the two lines. Least squares over the surrounding pixels give
/// the position, the directions of both edges, blur s, mean m and contrast h. The window is a
/// parallelogram that ends before the next edges, so small squares do not disturb each other. Blur
/// causes no bias: the model has the symmetry of a corner. Returns nullopt if the fit does not
/// converge near the guess, or if the edges are not visible.
///
/// cv::cornerSubPix is less accurate: it finds the point where gradients meet, and its window needs
/// straight edges and no neighbours. On rendered boards without noise its error per coordinate was
/// 0.25 px with squares of 4 px, and 0.02 px with large squares.
[[nodiscard]] std::optional<Eigen::Vector2d> fit_corner(ImageView<const std::uint8_t> image,
                                                        const CornerGuess& guess);

}  // namespace surefoot::calibration
