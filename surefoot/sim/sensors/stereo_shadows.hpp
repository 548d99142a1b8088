// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::sim {

/// Errors of window-based stereo matching at a pixel of the left image.
enum class Shadow : std::uint8_t {
    none,      ///< both cameras see the same point
    fattened,  ///< near a closer surface: the window takes that surface's disparity
    ramp,      ///< both cameras see the point, but a smooth matcher may bridge to a nearer surface
    occluded,  ///< hidden from the right camera: bridged or unknown
    outside,   ///< outside the right image
};

/// Shadows of disparity jumps. `bridge_px` is the disparity that an interpolating matcher would
/// report; NaN without a shadow, and where the interpolation has no support.
struct ShadowMap {
    Image<Shadow> shadow;
    Image<float> bridge_px;
};

struct ShadowConfig {
    double jump_px = 0.5;       ///< smallest jump between surfaces, beyond a slope of 0.2 px/px
    double fattening_px = 2.0;  ///< width of the seam beside the nearer surface
    double ramp_px = 8.0;       ///< largest width of a bridge, measured from the jump
};

/// Finds shadows from exact disparities and the surface of each pixel (-1 = none). Neighbouring
/// pixels of these images are `stride` real pixels apart, and disparities have the same unit; the
/// widths of `config` are in real pixels. A pixel is occluded if another pixel to its right appears
/// at its position or further left in the right image.
void find_shadows(const Image<float>& disparity_px,
                  const Image<std::int32_t>& surface,
                  const ShadowConfig& config,
                  int stride,
                  Executor& executor,
                  ShadowMap& out);

}  // namespace surefoot::sim
