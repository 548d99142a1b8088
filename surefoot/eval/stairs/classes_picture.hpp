// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/eval/report/picture.hpp"
#include "surefoot/stairs/classes/ground_classes.hpp"

namespace surefoot::eval {

/// Colour of a class, told apart by everybody: hues of Okabe and Ito (2008), neighbours on the
/// ground (floor, kerb, drop; tread, riser) far apart in lightness too. What is dangerous is warm,
/// what stands is dark. Unknown has none: it is hatched.
[[nodiscard]] Rgb8 color_of(stairs::GroundClass name);

/// What the ground is, cell by cell, with the area of each class that there is. Shown is what is
/// known, and what the overlays name, with some cells around it.
[[nodiscard]] Picture render_classes(const grid::GridGeometry& geometry,
                                     const grid::Layer& height_m,
                                     const stairs::GroundClasses& classes,
                                     const Overlays& overlays,
                                     const FigureText& text);

}  // namespace surefoot::eval
