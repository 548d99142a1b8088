// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::stereo {

/// Left-right check by projecting the left winners: every left pixel claims the right pixel it
/// matched, the nearest (largest disparity) claim stands, and a pixel whose right pixel is claimed
/// by something nearer by more than `tolerance_px` is hidden there: it becomes NaN. Matches that
/// fall outside the right image become NaN too. One matching pass instead of two.
void drop_hidden(Executor& executor, double tolerance_px, Image<float>& disparity_px);

/// Marks (255) the pixels on both sides of a jump: a known neighbour along the row or the column,
/// holes skipped, differs by more than `jump_px` plus 0.4 px for each pixel of distance, and the
/// middle between two pixels 4 apart that do. Ground seen at a usable angle slopes less (baseline /
/// camera height); the ramps that matchers draw behind edges more.
void mark_jumps(Executor& executor,
                const Image<float>& disparity_px,
                double jump_px,
                Image<std::uint8_t>& jumps);

/// Distances are counted up to here.
inline constexpr int kFarthest_px = 15;
/// Distance [px] of every pixel from the nearest marked one, along rows, columns and diagonals
/// alike; 255 stands for more than kFarthest_px. After Rosenfeld and Pfaltz 1966.
void distance_to_marks(Executor& executor,
                       const Image<std::uint8_t>& marks,
                       Image<std::uint8_t>& distance_px);

/// How many pixels around each are unknown.
struct UnknownCounts {
    Image<std::uint8_t> pixels;  ///< in the window of `radius_px`, as far as it lies in the image
    int radius_px = 0;
};
/// Windows hold at most 15 x 15 pixels: they are counted in bytes.
inline constexpr int kMaxCountRadius_px = 7;
void count_unknown(Executor& executor,
                   const Image<float>& disparity_px,
                   int radius_px,
                   UnknownCounts& counts);

/// How many of the positions 0 ... size - 1 are at most `radius` away from `center`.
constexpr int window_span(int center, int radius, int size) noexcept {
    return std::min(size - 1, center + radius) - std::max(0, center - radius) + 1;
}

}  // namespace surefoot::stereo
