// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

/// The loops of disparity_selection.cpp and consistency.cpp over one image row. They are compiled
/// once per instruction set and chosen at run time; every instruction set gives the same bytes.
namespace surefoot::stereo::rows {

/// Sets one bit per pixel, 64 in a word, lowest bit first. `known`: the pixel has a disparity.
/// `linked`: this pixel and the next are known and differ by at most `same_px`. Other bits are 0.
void link(const float* disparity_px,
          int width,
          float same_px,
          std::uint64_t* known,
          std::uint64_t* linked);

/// Computes the median of 3 x 3 disparities. Unknown (NaN) sorts below all numbers, so the median
/// is unknown only where at least five pixels are unknown. `lines`: the rows above, here and below.
/// The columns at the ends repeat. `scratch`: 3 (width + 2) floats.
void median(const float* const lines[3], int width, float* scratch, float* out);

/// Writes the claim of each left pixel: right column `place` and `offer` = 256 * cost + disparity.
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
    /// Disparity of the cheapest claim on the same right pixel.
    const std::uint8_t* claimed = nullptr;
    int width = 0;
    int uniqueness_percent = 0;
    int left_right_px = 0;
    float* disparity_px = nullptr;  ///< output
};
/// Computes one row of stereo::select_disparities.
void select(const SelectionRow& row);

/// A jump between known pixels is a difference larger than step_px + slope * distance.
struct JumpRule {
    float step_px = 0.0F;
    float slope = 0.0F;
};
/// Half the length of a ramp: a ramp spreads its step over 2 kRampHalf_px pixels.
inline constexpr int kRampHalf_px = 2;

/// Writes 255 into `mark` on both sides of a jump between neighbours of the row and in the middle
/// of a ramp of 2 kRampHalf_px. Writes 0 everywhere else.
void mark_along(const float* disparity_px, int width, JumpRule rule, std::uint8_t* mark);
/// Also marks the middle of each ramp between the rows kRampHalf_px above and below.
void mark_ramps(
    const float* above, const float* below, int width, JumpRule rule, std::uint8_t* mark);
/// Also marks both sides of each jump down a column. The upper side is the last known pixel of the
/// column, 1 + `rows_since` rows above, with the disparity `last_px` (NaN = no known pixel yet).
/// Each call updates both arrays. The next row of `mark` begins `stride` elements later.
void mark_down(const float* disparity_px,
               int width,
               JumpRule rule,
               float* last_px,
               float* rows_since,
               std::uint8_t* mark,
               std::ptrdiff_t stride);

/// Adds `sign` to the count of every column whose pixel is unknown.
void count_unknown(const float* disparity_px, int width, std::int8_t sign, std::uint8_t* counts);
/// Sums 2 radius + 1 counts; `counts` has `radius` more on either side. Each sum must fit a byte.
void sum_windows(const std::uint8_t* counts, int width, int radius, std::uint8_t* sums);

/// Number of rows and columns on either side whose smallest disparity smallest_nearby finds.
inline constexpr int kNearby_px = 2;
/// Writes the smallest known disparity of the 2 kNearby_px + 1 pixels around each pixel of the row;
/// infinity if all are unknown. `scratch`: width + 2 kNearby_px floats.
void smallest_along(const float* disparity_px, int width, float* scratch, float* out);
/// Writes the smallest value of each column of `lines`.
void smallest_across(const float* const lines[2 * kNearby_px + 1], int width, float* out);

/// Largest distance that is counted; 255 means more.
inline constexpr int kFarthest_px = 15;
/// Computes the distance [px] to the nearest mark of a row. `scratch`: 2 (width + 2 kSpreadMargin).
void spread_along(const std::uint8_t* mark,
                  int width,
                  std::uint8_t* scratch,
                  std::uint8_t* distance_px);
inline constexpr int kSpreadMargin = 80;
/// Lowers `distance_px` to at most 1 + the smallest of the three neighbours in the row `from`.
void spread_across(const std::uint8_t* from, int width, std::uint8_t* distance_px);

}  // namespace surefoot::stereo::rows
