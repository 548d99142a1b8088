// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "surefoot/calibration/bundle/board_bundle.hpp"

namespace surefoot::calibration {

/// Residuals of one image in the solution.
struct CameraFit {
    std::vector<int> ids;                       ///< ids of the board's points
    std::vector<Eigen::Vector2d> residuals_px;  ///< measured minus predicted, one per id
    std::vector<int> outliers;  ///< ids excluded from the estimate; residuals_px contains them too
    double rms_px = 0.0;        ///< rms length of the residuals without the outliers
};

/// Returns one fit per view of `solved`, for camera 0 or 1. `all`: sights before outlier removal.
[[nodiscard]] std::vector<CameraFit> camera_fits(const BoardBundle& solved,
                                                 std::span<const Sight> all,
                                                 std::span<const Sight> outliers,
                                                 int camera);

}  // namespace surefoot::calibration
