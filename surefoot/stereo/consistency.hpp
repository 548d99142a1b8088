// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::stereo {

/// Left-right check with the left disparities alone. Every left pixel claims the right pixel that
/// it matches, and the claim with the largest disparity (the nearest) wins. A left pixel becomes
/// NaN when the winning claim on its right pixel is larger by more than `tolerance_px`, because it
/// is hidden there. Matches outside the right image become NaN too. Needs no right disparities.
void drop_hidden(Executor& executor, double tolerance_px, Image<float>& disparity_px);

/// Writes 255 into `jumps` on both sides of a disparity jump. There the next known pixel of the row
/// or column differs by more than `jump_px` plus 0.4 px per pixel of distance. Also marks the
/// middle of two pixels 4 px apart with such a difference. Ground at a usable angle has a smaller
/// slope (baseline / camera height). The ramps that matchers draw behind edges have a larger slope.
void mark_jumps(Executor& executor,
                const Image<float>& disparity_px,
                double jump_px,
                Image<std::uint8_t>& jumps);

/// Largest distance that distance_to_marks counts.
inline constexpr int kFarthest_px = 15;
/// Computes the distance [px] of every pixel from the nearest marked pixel. A row, a column and a
/// diagonal step count 1 each. 255 means more than kFarthest_px. After Rosenfeld and Pfaltz 1966.
void distance_to_marks(Executor& executor,
                       const Image<std::uint8_t>& marks,
                       Image<std::uint8_t>& distance_px);

/// Computes the smallest known disparity [px] in the window of 5 x 5 pixels around each pixel;
/// infinity if all are unknown. A pixel with a much larger disparity lies on the near side of a
/// jump.
void smallest_nearby(Executor& executor,
                     const Image<float>& disparity_px,
                     Image<float>& smallest_px);

/// Number of unknown pixels around each pixel.
struct UnknownCounts {
    Image<std::uint8_t> pixels;  ///< counted in the window of `radius_px`, cut at the image border
    int radius_px = 0;
};
/// Largest radius: a window has at most 15 x 15 pixels, because a count must fit in a byte.
inline constexpr int kMaxCountRadius_px = 7;
void count_unknown(Executor& executor,
                   const Image<float>& disparity_px,
                   int radius_px,
                   UnknownCounts& counts);

/// Returns how many of the positions 0 ... size - 1 are at most `radius` away from `center`.
constexpr int window_span(int center, int radius, int size) noexcept {
    return std::min(size - 1, center + radius) - std::max(0, center - radius) + 1;
}

}  // namespace surefoot::stereo
