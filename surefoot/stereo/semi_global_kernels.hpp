// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "surefoot/stereo/census_window.hpp"

/// The inner loops of SemiGlobalSearch. Widths and counts are multiples of kLanes; every row of 64
/// bytes is aligned.
namespace surefoot::stereo::kernels {

inline constexpr int kLanes = 64;
/// Census bytes of one place in a strip, lane by lane: kCensusBytes rows of kLanes.
inline constexpr int kCensusRow = kCensusBytes * kLanes;

struct Penalties {
    std::uint8_t slope = 0;
    std::uint8_t jump = 0;
    std::uint8_t min_jump = 0;
    int contrast_shift = 0;
};

/// Census bytes of one row. `grey` points at its first pixel in an image with a border of
/// kCensusReach; `out[byte]` receives `width` values.
void census(const std::uint8_t* grey,
            std::ptrdiff_t stride,
            int width,
            std::uint8_t* const out[kCensusBytes]);

/// out[x][y] = in[y][x], 64 x 64 bytes; may turn a block in its place.
void transpose(const std::uint8_t* in,
               std::ptrdiff_t in_stride,
               std::uint8_t* out,
               std::ptrdiff_t out_stride);

/// 64 rows, side by side in the lanes.
struct RowStrip {
    const std::uint8_t* left = nullptr;   ///< [u] kCensusRow
    const std::uint8_t* right = nullptr;  ///< the same; `disparities` more stand before u = 0
    const std::uint8_t* grey = nullptr;   ///< [u] kLanes
    std::uint8_t* sums = nullptr;         ///< result, see follow_rows
    std::ptrdiff_t sums_stride = 0;
    std::uint8_t* state = nullptr;  ///< (disparities + 1) * kLanes
    int width = 0;
    int disparities = 0;
    Penalties penalties;
};
/// Sums of the paths from the left and from the right. Block by block of 64 columns they come to
/// lie with the columns in the lanes: column u of row v of the strip at
/// sums[(u / 64 * 64 + v) * sums_stride + d * 64 + u % 64].
void follow_rows(const RowStrip& strip);

/// Where winners of 64 columns go.
struct WinnerRows {
    std::uint8_t disparity[kLanes];
    std::uint8_t cost[kLanes];
    std::uint8_t cost_below[kLanes];
    std::uint8_t cost_above[kLanes];
    std::uint8_t second_cost[kLanes];
};
/// One row of 64 columns, side by side in the lanes.
struct ColumnStep {
    const std::uint8_t* left[kCensusBytes] = {};
    const std::uint8_t* right[kCensusBytes] = {};  ///< at the column of disparity 0
    const std::uint8_t* grey = nullptr;
    const std::uint8_t* grey_above = nullptr;
    const std::uint8_t* sums = nullptr;  ///< [d] kLanes, of the paths along the row
    std::uint8_t* state = nullptr;       ///< path from above: (disparities + 1) * kLanes, kept
    std::uint8_t* least = nullptr;       ///< least cost of that path, kLanes, kept
    int disparities = 0;
    Penalties penalties;
};
void follow_columns(const ColumnStep& step, WinnerRows& out);

}  // namespace surefoot::stereo::kernels
