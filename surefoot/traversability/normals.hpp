// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/disc.hpp"

namespace surefoot::traversability {

/// Points lie on a line if their second principal variance is at most this: (0.1 mm)^2.
inline constexpr double kMinMiddleVariance_m2 = 1e-8;

struct Normal {
    float x, y, z;
};
/// Returns the normal at one cell of a padded layer, with the rules of `normals`.
[[nodiscard]] Normal plain_normal(const float* center, const Disc& disc) noexcept;

/// Computes unit surface normals with z >= 0 for the cells of `rect`: the smallest eigenvector of
/// the covariance of the known cells within the disc. Unknown cells get NaN. Fewer than three known
/// cells, or cells on one line in space, span no plane and give +z. A disc of a single cell gives
/// NaN everywhere, because it would always report flat ground.
void normals(const PaddedLayer& height_m,
             const Disc& disc,
             const CellRect& rect,
             grid::Layer& normal_x,
             grid::Layer& normal_y,
             grid::Layer& normal_z);

}  // namespace surefoot::traversability
