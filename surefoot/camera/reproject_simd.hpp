// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace surefoot::camera {

/// Points of one disparity row: z = depth_to_disparity / disparity, x = ray_x * z, y = ray_y * z.
/// All are NaN unless 0 < z < infinity.
struct DisparityRow {
    const float* disparity_px;
    const float* ray_x;
    float ray_y;
    float depth_to_disparity_px_m;
    int width;
};
void reproject_row(const DisparityRow& row, Eigen::Vector3f* out);

}  // namespace surefoot::camera
