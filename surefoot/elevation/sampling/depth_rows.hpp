// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/elevation/fusion/cell_groups.hpp"
#include "surefoot/elevation/sampling/pixel_filter.hpp"

namespace surefoot::elevation {

/// Data shared by all pixels of a frame, in floats. Heights and positions count as in GridPoint.
struct DepthFrame {
    float cx_px = 0.0F;
    float per_fx = 0.0F;
    float depth_to_disparity_px_m = 0.0F;
    float per_focal_px = 0.0F;  ///< 1 / focal length, for the lateral error
    float lateral_px = 0.0F;
    float min_var_m2 = 0.0F;
    float tilt_var = 0.0F;  ///< variance of roll and of pitch [rad^2]
    float camera_m[3] = {};
    float min_range_m = 0.0F;
    float max_range_m = 0.0F;
    float max_z_m = 0.0F;
    float max_outlier_probability = 0.0F;
    bool surface_check = true;
    SurfaceLimits surface;
    float per_cell_m = 0.0F;  ///< 1 / resolution
    int nx = 0;
    int ny = 0;
};

/// One row of a depth image. The ray (x, y, 1) of a pixel in odom axes is x * along + start.
struct DepthRow {
    const float* disparity_px = nullptr;
    const float* sigma_px = nullptr;
    const float* outlier_probability = nullptr;
    const float* before_px = nullptr;  ///< left neighbours at `reach_px`; NaN = no match
    const float* after_px = nullptr;   ///< right neighbours at `reach_px`; NaN = no match
    const float* above_px = nullptr;
    const float* below_px = nullptr;
    int width = 0;
    float ray_y = 0.0F;
    float start[3] = {};
    float along[3] = {};
};

struct RowCounts {
    std::int64_t points = 0;
    std::int64_t gated_confidence = 0;
    std::int64_t gated_range = 0;
    std::int64_t gated_height = 0;
    std::int64_t outside = 0;
    std::size_t samples = 0;
};

/// Writes the samples of the accepted pixels of a row, from left to right. Uses the sensor model
/// `matcher`, as `points_from_depth` does, but in floats. Every instruction set gives the same
/// bytes. May write up to `CellSamples::kSlack` elements beyond the last sample of `out`.
RowCounts samples_of_row(const DepthFrame& frame, const DepthRow& row, CellSamples::Columns out);

}  // namespace surefoot::elevation
