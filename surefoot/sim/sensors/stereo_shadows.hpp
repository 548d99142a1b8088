// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::sim {

/// What a window that is slid over two images gets wrong in a pixel of the left one.
enum class Shadow : std::uint8_t {
    none,      ///< both eyes see the same place
    fattened,  ///< so near to a nearer surface that the window takes its disparity
    ramp,      ///< both see it, but a smooth matcher may put a bridge to the nearer surface here
    occluded,  ///< the right eye does not see it: a bridge, or nothing
    outside,   ///< the right image ends before it
};

/// Shadows of disparity jumps. `bridge_px` is what a matcher that interpolates would say; NaN where
/// it has nothing to hold on to, and without shadow.
struct ShadowMap {
    Image<Shadow> shadow;
    Image<float> bridge_px;
};

struct ShadowConfig {
    double jump_px = 0.5;       ///< smallest jump between neighbours on two surfaces
    double fattening_px = 2.0;  ///< width of the seam
    double ramp_px = 8.0;       ///< width of what bridges may cover, counted from the jump
};

/// Shadows from exact disparities and the surface of each pixel (-1 = none). `stride`: neighbours
/// in these images are so many real pixels apart, and disparities are in units of them too; the
/// widths of `config` are real pixels. A pixel is occluded when another one to its right appears at
/// its place or further left in the right image.
void find_shadows(const Image<float>& disparity_px,
                  const Image<std::int32_t>& surface,
                  const ShadowConfig& config,
                  int stride,
                  Executor& executor,
                  ShadowMap& out);

}  // namespace surefoot::sim
