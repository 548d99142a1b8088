// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "surefoot/calibration/bundle/board_bundle.hpp"

namespace surefoot::calibration {

/// What one image says about the solution.
struct CameraFit {
    std::vector<int> ids;                       ///< of the board's points
    std::vector<Eigen::Vector2d> residuals_px;  ///< measured minus predicted, one per id
    std::vector<int> outliers;  ///< ids left out of the estimate; their residuals are above too
    double rms_px = 0.0;        ///< root of the mean squared distance of the points used
};

/// One per view of `solved`, for the eye 0 or 1. `all` are the sights before any left the bundle.
[[nodiscard]] std::vector<CameraFit> camera_fits(const BoardBundle& solved,
                                                 std::span<const Sight> all,
                                                 std::span<const Sight> outliers,
                                                 int camera);

}  // namespace surefoot::calibration
