// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::odometry {

struct CornerConfig {
    int grid_columns = 16;
    int grid_rows = 10;
    int most = 240;                ///< wanted number of corners, including the `occupied` points
    double min_gradient = 2.5;     ///< smallest rms grey step per pixel in the weaker direction
    double min_distance_px = 8.0;  ///< smallest distance from another corner
    int border_px = 14;            ///< smallest distance from the image border
};

/// Detects corners (Shi and Tomasi 1994: the weaker eigenvalue of the gradient's second moments),
/// spread over a grid. Each cell gets its share of `most`, minus the points it already holds
/// (`occupied`). Cells are independent, so every executor gives the same corners.
void detect_corners(ImageView<const std::uint8_t> image,
                    std::span<const Eigen::Vector2d> occupied,
                    const CornerConfig& config,
                    Executor& executor,
                    std::vector<Eigen::Vector2d>& corners);

}  // namespace surefoot::odometry
