// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

/// The loops of SubpixelRefiner and of the confidence over one row of an image, compiled once for
/// every instruction set and chosen at run time; all give the same bytes, because sums of floats
/// are not re-ordered and nothing is contracted.
namespace surefoot::stereo::rows {

/// Binomial 1 4 6 4 1 in both directions, in 1/16 grey level. `in`: five rows around the one that
/// is made; `scratch`: width + 4.
void smooth_image(const std::uint8_t* const in[5],
                  int width,
                  std::uint16_t* scratch,
                  std::int16_t* out);

struct SmoothRow {
    const float* center = nullptr;
    /// The lines k + 1 pixels away on either side, already shifted.
    const float* const* before = nullptr;
    const float* const* after = nullptr;
    int steps = 0;
    int width = 0;
    float same_surface_px = 0.0F;
    float* out = nullptr;
    /// What counts instead of `center` where half of that difference is not exceeded; the other
    /// lines lie around it. Or nothing.
    const float* ahead = nullptr;
};
/// See stereo::smooth_along.
void smooth_along(const SmoothRow& row);

/// What a pixel tells about its shift: the gradient [1/16 grey level per pixel] in the lower half,
/// the grey difference between the eyes in the upper one; kUnused tells nothing.
inline constexpr std::int32_t kUnused = std::numeric_limits<std::int32_t>::min();

struct WarpRow {
    const std::int16_t* left = nullptr;   ///< smoothed, 1/16 grey level
    const std::int16_t* right = nullptr;  ///< the same; one more pixel stands before the row
    const float* disparity_px = nullptr;
    const std::uint8_t* jump_distance_px = nullptr;
    int jump_margin_px = 0;
    int width = 0;
    std::int32_t* evidence = nullptr;
    // Scratch of the row: where each pixel lies in the right row (0: nowhere), and the four pixels
    // there, two to a word.
    std::int32_t* place = nullptr;
    float* fraction = nullptr;
    std::int32_t* pairs = nullptr;  ///< 2 width
};
/// Grey difference and gradient of every pixel at its disparity.
void warp(const WarpRow& row);

/// Exact sums over the columns of a window: count and e, g, gg, ge, ee, each `width` long and
/// kPadding zeros. The first holds kCounted times the sum of e and the number of pixels.
inline constexpr int kSums = 5;
inline constexpr int kCountBits = 11;
inline constexpr std::int32_t kCounted = 1 << kCountBits;
/// Registers may reach this far beyond the end of a row.
inline constexpr int kPadding = 64;
/// One row of evidence enters the window, another leaves it.
void slide(const std::int32_t* entering,
           const std::int32_t* leaving,
           int width,
           std::int32_t* const columns[kSums]);

struct SolveRow {
    const std::int32_t* columns[kSums] = {};
    std::int32_t* prefix[kSums] = {};  ///< scratch, width + 2 * radius_px + 1 + kPadding each
    int radius_px = 0;
    int width = 0;
    float enough = 0.0F;
    float correlation = 0.0F;
    float min_noise_grey = 0.0F;
    float prior_sigma_px = 0.0F;
    float max_step_px = 0.0F;
    float* disparity_px = nullptr;  ///< NaN = unknown stays so; else moved by the shift
    float* shift_px = nullptr;
    float* residual_grey = nullptr;
    float* gradient_grey_px = nullptr;
};
void solve(const SolveRow& row);

struct RateRow {
    const float* disparity_px = nullptr;
    const float* residual_grey = nullptr;
    const float* gradient_grey_px = nullptr;
    const float* shift_px = nullptr;
    const std::uint8_t* jump_distance_px = nullptr;
    const std::uint8_t* unknown_count = nullptr;  ///< see UnknownCounts
    int unknown_radius_px = 0;
    int unknown_rows = 0;  ///< that the windows of this row have inside the image
    int width = 0;
    float* sigma_px = nullptr;
    float* outlier_probability = nullptr;
};
void rate(const RateRow& row);

}  // namespace surefoot::stereo::rows
