// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// The loops of SubpixelRefiner and of the confidence over one row of an image. Plain loops,
/// compiled once for every instruction set and chosen at run time; all give the same bytes, because
/// nothing in them may be re-ordered or contracted.
namespace surefoot::stereo::rows {

/// Binomial 1 4 6 4 1 in both directions, in 1/16 grey level. `in`: five rows around the one that
/// is made; `scratch`: width + 4.
void smooth_image(const std::uint8_t* const in[5], int width, int* scratch, std::int16_t* out);

struct SmoothRow {
    const float* center = nullptr;
    /// The lines k + 1 pixels away on either side, already shifted.
    const float* const* before = nullptr;
    const float* const* after = nullptr;
    int steps = 0;
    int margin_per_step = 0;  ///< 1: the first and last k + 1 pixels have no partners there
    int width = 0;
    float same_surface_px = 0.0F;
    float* out = nullptr;
};
/// See stereo::smooth_along.
void smooth_along(const SmoothRow& row);

struct WarpRow {
    const std::int16_t* left = nullptr;   ///< smoothed, 1/16 grey level
    const std::int16_t* right = nullptr;  ///< the same
    const float* disparity_px = nullptr;
    const std::uint8_t* jump_distance_px = nullptr;
    int jump_margin_px = 0;
    int width = 0;
    std::int16_t* gradient = nullptr;
    std::int16_t* error = nullptr;
    std::int16_t* used = nullptr;
    // Scratch of the row: where in the right row, and its four pixels there, side by side and
    // apart.
    std::int32_t* place = nullptr;
    float* fraction = nullptr;
    std::int16_t* fours = nullptr;  ///< 4 (width + kTapPadding)
    std::int16_t* taps[4] = {};     ///< width + kTapPadding each
};
/// Registers may reach this far beyond the end of the row.
inline constexpr int kTapPadding = 64;
/// Grey difference and gradient of every pixel at its disparity.
void warp(const WarpRow& row);

/// Exact sums over the columns of a window: n, g, e, gg, ge, ee, each `width` long.
inline constexpr int kSums = 6;
void accumulate(const std::int16_t* g,
                const std::int16_t* e,
                const std::int16_t* used,
                std::int32_t sign,
                int width,
                std::int32_t* const columns[kSums]);

struct SolveRow {
    const std::int32_t* columns[kSums] = {};
    std::uint32_t* prefix[kSums] = {};  ///< scratch, width + 2 * radius_px + 1 each
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
    const float* unknown_share = nullptr;
    int width = 0;
    float* sigma_px = nullptr;
    float* outlier_probability = nullptr;
};
void rate(const RateRow& row);

}  // namespace surefoot::stereo::rows
