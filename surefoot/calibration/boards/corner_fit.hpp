// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "surefoot/core/views.hpp"

namespace surefoot::calibration {

/// Where a corner of a chessboard roughly lies, and how the board's lines run through it.
struct CornerGuess {
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    Eigen::Vector2d along_row_px = Eigen::Vector2d::Zero();     ///< to the next corner of its row
    Eigen::Vector2d along_column_px = Eigen::Vector2d::Zero();  ///< to the next of its column
    /// Curvature of the image of its row and its column, positive towards the normal, which is the
    /// direction turned by +90 deg (x right, y down). A lens bends straight lines: by a window of
    /// 10 px in a fisheye image of f = 240 px a line departs up to 0.05 px.
    double row_bend_per_px = 0.0;
    double column_bend_per_px = 0.0;
};

/// A corner to sub-pixels: the picture of two blurred edges that cross,
///
///     m + h erf(d1 / (sqrt(2) s)) erf(d2 / (sqrt(2) s)),
///
/// with d1, d2 the distances from the two lines, is fitted to the pixels around it by least squares
/// (place, directions of both edges, blur s, mean m, contrast h). The window is a parallelogram
/// that ends short of the next edges, so that small squares do not disturb each other and blur
/// moves nothing: the model has the symmetry of a corner. Gives nothing where the fit does not
/// settle near the guess, or the edges do not show.
///
/// Why not the point where gradients meet (cv::cornerSubPix): its window wants straight edges and
/// no neighbours. On rendered boards it erred by 0.25 px (per coordinate) with squares of 4 px, and
/// by 0.02 px with large ones, noise aside.
[[nodiscard]] std::optional<Eigen::Vector2d> fit_corner(ImageView<const std::uint8_t> image,
                                                        const CornerGuess& guess);

}  // namespace surefoot::calibration
