// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "surefoot/core/views.hpp"

namespace surefoot::stereo {

/// Position of a window of one image in another image: centre there minus centre here.
struct WindowShift {
    double columns_px = 0.0;
    double rows_px = 0.0;
};

/// Half the side of the window, without its centre [px].
inline constexpr int kShiftHalf_px = 7;

/// Refines a whole-pixel match of the window around (u_px, v_px) of `left` to a fraction of a
/// pixel. `start` is the whole-pixel shift.
///
/// Gauss-Newton on the grey values (Lucas and Kanade 1981; steps use the gradients of the left
/// image alone, Baker and Matthews 2004). Unknowns: both shifts, the slant of the columns along
/// either side of the window (ground seen from above moves by most of a pixel within it), gain and
/// offset. A parabola through a correlation prefers whole pixels: texture of two pixels loses a
/// tenth of every fraction. Here only interpolation could do this, and it uses six pixels. Noise
/// adds no bias: the left gradients' noise is independent of the right image's noise.
///
/// Returns nothing when the window leaves an image, has no texture in some direction, or ends
/// farther than a pixel from `start`.
[[nodiscard]] std::optional<WindowShift> refine_shift(ImageView<const std::uint8_t> left,
                                                      ImageView<const std::uint8_t> right,
                                                      int u_px,
                                                      int v_px,
                                                      const WindowShift& start);

}  // namespace surefoot::stereo
