// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "surefoot/core/views.hpp"

namespace surefoot::stereo {

/// Position of a window in another image: centre there minus centre in this image.
struct WindowShift {
    double columns_px = 0.0;
    double rows_px = 0.0;
};

/// Half the side of the window [px], without the centre pixel.
inline constexpr int kShiftHalf_px = 7;

/// Refines a whole-pixel match of the window around (u_px, v_px) of `left` to a fraction of a
/// pixel. `start` is the whole-pixel shift.
///
/// Method: Gauss-Newton on the grey values (Lucas and Kanade 1981); steps use only gradients of the
/// left image (Baker and Matthews 2004). Unknowns: both shifts, gain, offset, and the change of the
/// column shift along both sides of the window (nearly a pixel for ground seen from above). A
/// parabola through correlations leans toward whole pixels: a texture of two-pixel grains makes the
/// fraction a tenth too small. Here only the interpolation, over six pixels, can cause this error.
/// Noise adds no bias: the noise of the left gradients is independent of the right image's noise.
///
/// Returns nothing if the window leaves an image or has no texture in some direction. Also returns
/// nothing if it slants too much, ends more than one pixel from `start`, or does not converge.
[[nodiscard]] std::optional<WindowShift> refine_shift(ImageView<const std::uint8_t> left,
                                                      ImageView<const std::uint8_t> right,
                                                      int u_px,
                                                      int v_px,
                                                      const WindowShift& start);

}  // namespace surefoot::stereo
