// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/eval/report/picture.hpp"
#include "surefoot/stairs/classes/ground_classes.hpp"

namespace surefoot::eval {

/// Returns the colour of a class. Most hues are those of Okabe and Ito (2008), for all common kinds
/// of colour vision. Classes that meet on the ground (floor, kerb, drop; tread, riser) also differ
/// in lightness. Kerbs and drops are warm, walls are dark. Pictures show unknown cells hatched.
[[nodiscard]] Rgb8 color_of(stairs::GroundClass name);

/// Draws the ground class of each cell, with the area of each class in the legend. Shows the known
/// cells and the overlays (marks, path, body), with some cells around them.
[[nodiscard]] Picture render_classes(const grid::GridGeometry& geometry,
                                     const grid::Layer& height_m,
                                     const stairs::GroundClasses& classes,
                                     const Overlays& overlays,
                                     const FigureText& text);

}  // namespace surefoot::eval
