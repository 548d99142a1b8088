// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::grid {

/// Returns the variance of the heights against the vertical: the variance of each cell plus that of
/// a tilted z axis, (tilt sigma times horizontal distance from the origin of odom)^2. A tilt does
/// not change the heights at the origin, where odom was placed on the ground.
///
/// `tilt_sigma_rad`: one sigma about any horizontal axis. If it is not finite, the tilt is unknown
/// and all known variances become infinite. NaN stays NaN.
[[nodiscard]] Layer with_tilt_variance(ImageView<const float> variance_m2,
                                       const GridGeometry& geometry,
                                       double tilt_sigma_rad);

}  // namespace surefoot::grid
