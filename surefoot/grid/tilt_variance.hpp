// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::grid {

/// Variance of heights against the vertical: that of each cell, and what a leaning z axis adds,
/// (tilt sigma times the horizontal distance from the origin of odom)^2. The heights at the origin,
/// where odom was placed on the ground, do not change by a tilt.
///
/// `tilt_sigma_rad`: one sigma about any horizontal axis; not finite = not known, and all known
/// variances become infinite. NaN stays NaN.
[[nodiscard]] Layer with_tilt_variance(ImageView<const float> variance_m2,
                                       const GridGeometry& geometry,
                                       double tilt_sigma_rad);

}  // namespace surefoot::grid
