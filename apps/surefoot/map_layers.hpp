// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "surefoot/eval/maps/layer_sheet.hpp"
#include "surefoot/pipeline/pipeline.hpp"

namespace surefoot::app {

/// A layer by its name in files.
struct NamedLayer {
    const char* name;
    grid::Layer values;
};

/// Every layer of a map and of its rating, heights' bounds included; unknown where nothing has
/// filled one yet. In the order in which they are read.
[[nodiscard]] std::vector<NamedLayer> all_layers(const pipeline::Pipeline& pipeline);

/// PNG of all of them, `columns` side by side; heights share the range of the elevation, so that
/// their colours can be compared.
[[nodiscard]] std::vector<std::uint8_t> layer_sheet_png(const grid::GridGeometry& geometry,
                                                        std::span<const NamedLayer> layers,
                                                        double safe_threshold,
                                                        int columns,
                                                        const eval::FigureText& text,
                                                        const eval::Overlays& overlays);

}  // namespace surefoot::app
