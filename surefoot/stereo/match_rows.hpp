// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

/// The loops of settle.cpp and consistency.cpp over one row of an image, compiled once for every
/// instruction set and chosen at run time; all give the same bytes.
namespace surefoot::stereo::rows {

/// One bit for each pixel, 64 to a word, the first one lowest: whether it is known, and whether it
/// and the next one are and differ by at most `same_px`. Bits beyond the end are 0.
void link(const float* disparity_px,
          int width,
          float same_px,
          std::uint64_t* known,
          std::uint64_t* linked);

/// Median of 3 x 3 disparities; unknown (NaN) counts as less than all, so that it is the median
/// only where five are unknown. `lines`: rows above, here and below; columns beyond the ends
/// repeat. `scratch`: 3 (width + 2).
void median(const float* const lines[3], int width, float* scratch, float* out);

/// What each left pixel claims: `place` its right pixel, and `offer` 256 * cost + disparity.
void claim(const std::uint8_t* disparity,
           const std::uint8_t* cost,
           int width,
           std::int32_t* place,
           std::uint16_t* offer);

struct SelectionRow {
    const std::uint8_t* disparity = nullptr;
    const std::uint8_t* cost = nullptr;
    const std::uint8_t* cost_below = nullptr;
    const std::uint8_t* cost_above = nullptr;
    const std::uint8_t* second_cost = nullptr;
    /// Disparity with which the right pixel of this match was claimed most cheaply.
    const std::uint8_t* claimed = nullptr;
    int width = 0;
    int uniqueness_percent = 0;
    int left_right_px = 0;
    float* disparity_px = nullptr;  ///< out
};
/// See stereo::select_disparities.
void select(const SelectionRow& row);

/// What counts as a jump between known pixels: a difference above step_px + slope * distance.
struct JumpRule {
    float step_px = 0.0F;
    float slope = 0.0F;
};
/// Half the pixels over which the steps of a ramp are spread.
inline constexpr int kRampHalf_px = 2;

/// Writes 255 into `mark` on both sides of a jump between neighbours of the row, and in the middle
/// of a ramp of 2 kRampHalf_px; else 0.
void mark_along(const float* disparity_px, int width, JumpRule rule, std::uint8_t* mark);
/// Adds the middles of ramps between the rows kRampHalf_px above and below.
void mark_ramps(
    const float* above, const float* below, int width, JumpRule rule, std::uint8_t* mark);
/// Adds both sides of jumps from the last known pixel of each column, which is `last_px` (NaN:
/// none) and lies 1 + `rows_since` rows above; both are kept from row to row. `mark` is followed by
/// the next row after `stride` elements.
void mark_down(const float* disparity_px,
               int width,
               JumpRule rule,
               float* last_px,
               float* rows_since,
               std::uint8_t* mark,
               std::ptrdiff_t stride);

/// Adds `sign` to the count of every column whose pixel is unknown.
void count_unknown(const float* disparity_px, int width, std::int8_t sign, std::uint8_t* counts);
/// Sums of 2 radius + 1 neighbours: `counts` has `radius` more on either side. They must fit.
void sum_windows(const std::uint8_t* counts, int width, int radius, std::uint8_t* sums);

/// Distances are counted up to here, 255 beyond.
inline constexpr int kFarthest_px = 15;
/// Distance from the nearest marked pixel of the row. `scratch`: 2 (width + 2 kSpreadMargin).
void spread_along(const std::uint8_t* mark,
                  int width,
                  std::uint8_t* scratch,
                  std::uint8_t* distance_px);
inline constexpr int kSpreadMargin = 80;
/// Lessens `distance_px` to one more than the least of three neighbours in the row `from`.
void spread_across(const std::uint8_t* from, int width, std::uint8_t* distance_px);

}  // namespace surefoot::stereo::rows
