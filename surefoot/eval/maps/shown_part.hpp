// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/views.hpp"
#include "surefoot/eval/maps/map_view.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::eval {

/// The displayed part of a map; its narrow rim may extend beyond the map.
struct ShownPart {
    grid::GridGeometry geometry;
    int first_ix = 0;  ///< index of the first shown cell in the map
    int first_iy = 0;

    /// Copies this part of a layer of the map; cells outside the map get `beyond`.
    template <typename T>
    [[nodiscard]] Image<T> of(const Image<T>& layer, T beyond) const {
        Image<T> part(geometry.nx, geometry.ny, beyond);
        for (int iy = 0; iy < geometry.ny; ++iy) {
            for (int ix = 0; ix < geometry.nx; ++ix)
                if (layer.contains(first_ix + ix, first_iy + iy))
                    part.at(ix, iy) = layer.at(first_ix + ix, first_iy + iy);
        }
        return part;
    }
};

/// Returns the part with the known cells and the overlays (marks, path, body), and some cells
/// around them. Returns the whole map if there are neither known cells nor overlays.
[[nodiscard]] ShownPart shown_part(const grid::GridGeometry& geometry,
                                   const grid::Layer& height_m,
                                   const Overlays& overlays);

}  // namespace surefoot::eval
