// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "surefoot/eval/report/picture.hpp"

namespace surefoot::eval {

/// Returns the colour of each known cell on `scale`, with hill shading if the style enables it.
[[nodiscard]] Image<std::optional<Rgb8>> cell_colors(const grid::GridGeometry& geometry,
                                                     const grid::Layer& layer,
                                                     const LayerStyle& style,
                                                     const ColorScale& scale);

}  // namespace surefoot::eval
