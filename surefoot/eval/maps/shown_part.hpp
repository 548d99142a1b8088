// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/views.hpp"
#include "surefoot/eval/maps/map_view.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::eval {

/// The displayed part of a map; its narrow rim may extend beyond the map.
struct ShownPart {
    grid::GridGeometry geometry;
    int first_ix = 0;  ///< cell index in the map
    int first_iy = 0;

    /// This part of a layer of the map; `beyond` outside the map.
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

/// The known cells and the overlays (marks, path, body), with some cells around them; the whole map
/// if there are neither.
[[nodiscard]] ShownPart shown_part(const grid::GridGeometry& geometry,
                                   const grid::Layer& height_m,
                                   const Overlays& overlays);

}  // namespace surefoot::eval
