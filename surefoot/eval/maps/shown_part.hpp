// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/views.hpp"
#include "surefoot/eval/maps/map_view.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::eval {

/// The part of a map that is worth showing; its narrow rim may lie beyond the map.
struct ShownPart {
    grid::GridGeometry geometry;
    int first_ix = 0;  ///< of the map
    int first_iy = 0;

    /// That part of a layer of the map; `beyond` where there is no map.
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

/// What is known, and what the overlays name (marks, the way, the body), with some cells around it;
/// the whole map where there is nothing of that.
[[nodiscard]] ShownPart shown_part(const grid::GridGeometry& geometry,
                                   const grid::Layer& height_m,
                                   const Overlays& overlays);

}  // namespace surefoot::eval
