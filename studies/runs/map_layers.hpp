// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "surefoot/eval/maps/layer_sheet.hpp"
#include "surefoot/pipeline/pipeline.hpp"

namespace surefoot::app {

/// Names of all layers, in display order. `run --layers` writes NAME.asc for each.
inline constexpr std::array kLayerNames{
    "elevation",     "variance",       "drift",       "confidence",    "count",
    "density_ratio", "highest",        "lowest",      "clearance",     "free_above",
    "foothold",      "normal_x",       "normal_y",    "normal_z",      "slope",
    "step",          "roughness",      "lower_bound", "upper_bound",   "rating_confidence",
    "smallest_step", "not_resolvable", "reach_step",  "traversability"};

/// A layer and its name in files and pictures.
struct NamedLayer {
    const char* name;
    grid::Layer values;
};

/// Returns all layers of the map and of its rating, with the height bounds, in the order of
/// kLayerNames. A layer that was not computed has only unknown cells.
[[nodiscard]] std::vector<NamedLayer> all_layers(const pipeline::Pipeline& pipeline);

/// Returns a PNG that shows all layers, with `columns` layers side by side. The layers highest and
/// lowest and the height bounds share the colour range of the elevation.
[[nodiscard]] std::vector<std::uint8_t> layer_sheet_png(const grid::GridGeometry& geometry,
                                                        std::span<const NamedLayer> layers,
                                                        double safe_threshold,
                                                        int columns,
                                                        const eval::FigureText& text,
                                                        const eval::Overlays& overlays);

}  // namespace surefoot::app
