// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

/// The loops of SubpixelRefiner and of the confidence over one image row. They are compiled once
/// per instruction set and chosen at run time. Every instruction set gives the same bytes, because
/// no float sum is re-ordered and no operation is contracted.
namespace surefoot::stereo::rows {

/// Applies the binomial filter 1 2 1 in both directions; the result is in 1/16 grey level.
/// `in`: the three rows around the output row. `scratch`: width + 2 elements.
void smooth_image(const std::uint8_t* const in[3],
                  int width,
                  std::uint16_t* scratch,
                  std::int16_t* out);

struct SmoothRow {
    const float* center = nullptr;
    /// The lines k + 1 pixels before and after, already shifted to the position of the pixel.
    const float* const* before = nullptr;
    const float* const* after = nullptr;
    int steps = 0;
    int width = 0;
    float same_surface_px = 0.0F;
    float* out = nullptr;
};
/// Does the work of stereo::smooth_along and smooth_down.
void smooth_along(const SmoothRow& row);

/// Evidence of a pixel about its shift. Lower half: gradient [1/16 grey level per pixel]. Upper
/// half: grey difference left - right [1/16]. kUnused marks a pixel without evidence.
inline constexpr std::int32_t kUnused = std::numeric_limits<std::int32_t>::min();

struct WarpRow {
    const std::int16_t* left = nullptr;   ///< smoothed, 1/16 grey level
    const std::int16_t* right = nullptr;  ///< smoothed, with one more pixel before the row
    const float* disparity_px = nullptr;
    const std::uint8_t* jump_distance_px = nullptr;
    int jump_margin_px = 0;
    int width = 0;
    std::int32_t* evidence = nullptr;
    // Scratch of the row: the position of each pixel in the right row (0: outside or beside a
    // jump), and the four right pixels around that position, two in a word.
    std::int32_t* place = nullptr;
    float* fraction = nullptr;
    std::int32_t* pairs = nullptr;  ///< 2 * width elements
};
/// Computes the grey difference and gradient of every pixel at its disparity.
void warp(const WarpRow& row);

/// Number of exact sums over the columns of a window: count and e, g, gg, ge, ee. Each has `width`
/// elements, then kPadding zeros. The first holds kCounted times the sum of e, plus the count.
inline constexpr int kSums = 5;
inline constexpr int kCountBits = 11;
inline constexpr std::int32_t kCounted = 1 << kCountBits;
/// Number of elements that a register may reach beyond the end of a row.
inline constexpr int kPadding = 64;
/// Moves the window down by one row: adds the row `entering`, subtracts the row `leaving`.
void slide(const std::int32_t* entering,
           const std::int32_t* leaving,
           int width,
           std::int32_t* const columns[kSums]);

struct SolveRow {
    const std::int32_t* columns[kSums] = {};
    std::int32_t* prefix[kSums] = {};  ///< scratch: width + 2 * radius_px + 1 + kPadding elements
    int radius_px = 0;
    int width = 0;
    float enough = 0.0F;
    float correlation = 0.0F;
    float min_noise_grey = 0.0F;
    float prior_sigma_px = 0.0F;
    float max_step_px = 0.0F;
    float* disparity_px = nullptr;  ///< changed by the shift; NaN = unknown, stays unknown
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
    const float* smallest_px = nullptr;           ///< see stereo::smallest_nearby
    const std::uint8_t* unknown_count = nullptr;  ///< see UnknownCounts
    int unknown_radius_px = 0;
    int unknown_rows = 0;  ///< number of rows of the windows inside the image
    int width = 0;
    float* sigma_px = nullptr;
    float* outlier_probability = nullptr;
};
void rate(const RateRow& row);

}  // namespace surefoot::stereo::rows
