// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/disc.hpp"

namespace surefoot::traversability {

/// Unit surface normals with z >= 0 for the cells of `rect`: smallest eigenvector of the covariance
/// of the known cells within the disc. Unknown cells get NaN. Fewer than three known cells, or
/// cells on one line in space, span no plane and give +z; a disc of a single cell gives NaN
/// everywhere, because it could call nothing but flat.
void normals(const PaddedLayer& height_m,
             const Disc& disc,
             const CellRect& rect,
             grid::Layer& normal_x,
             grid::Layer& normal_y,
             grid::Layer& normal_z);

}  // namespace surefoot::traversability
