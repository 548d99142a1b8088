// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "surefoot/eval/report/picture.hpp"

namespace surefoot::eval {

/// One layer of a sheet, in the colours of its style, with a title above it.
struct SheetLayer {
    grid::Layer values;
    LayerStyle style;
};

/// Style of a layer of the map or of its rating, by its name in files. Give "variance" as one sigma
/// in m; it is shown in mm. A layer of unknown name is shown as plain numbers.
[[nodiscard]] LayerStyle style_of_layer(std::string_view name, double safe_threshold);

/// Draws layers of one map side by side, `columns` in a row, each with its own legend. x forward is
/// up, y left is left, unknown cells are hatched. Shows the cells that a layer knows and the cells
/// of the path, with a margin. Draws the path on the first map. Empty picture without a layer.
[[nodiscard]] Picture render_layer_sheet(const grid::GridGeometry& geometry,
                                         const std::vector<SheetLayer>& layers,
                                         int columns,
                                         const FigureText& text,
                                         const Overlays& overlays);

}  // namespace surefoot::eval
