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

/// The sums of 64 x 64 pixels: groups of disparities, column by column (row by row once they are
/// turned). So whoever walks along the disparities and whoever turns a group both stay on a few
/// pages.
inline constexpr int kGroup = 8;
/// One disparity and one column more than needed: places a power of two apart share their lines of
/// the cache.
inline constexpr int kSumsColumn = (kGroup + 1) * kLanes;
inline constexpr int kSumsGroup = (kLanes + 1) * kSumsColumn;

struct Penalties {
    std::uint8_t slope = 0;
    std::uint8_t jump = 0;
    std::uint8_t min_jump = 0;
    int contrast_shift = 0;
};

/// Census bytes of one row, arranged as the processor counts their differences best. `grey` points
/// at its first pixel in an image with a border of kCensusReach; `out[byte]` receives `width`
/// values.
void census(const std::uint8_t* grey,
            std::ptrdiff_t stride,
            int width,
            std::uint8_t* const out[kCensusBytes]);

/// out[x][y] = in[y][x], 64 x 64 bytes.
void transpose(const std::uint8_t* in,
               std::ptrdiff_t in_stride,
               std::uint8_t* out,
               std::ptrdiff_t out_stride);

/// Up to 64 columns of 64 rows, the rows side by side in the lanes.
struct RowBlock {
    const std::uint8_t* left = nullptr;   ///< [column] kCensusRow
    const std::uint8_t* right = nullptr;  ///< the same; `disparities` more stand before column 0
    const std::uint8_t* grey = nullptr;   ///< [column] kLanes
    /// Of the column that the path comes from; at the edge of the image that of its first one.
    const std::uint8_t* grey_before = nullptr;
    std::uint8_t* state = nullptr;  ///< of the path: (disparities + 1) * kLanes, kept
    std::uint8_t* least = nullptr;  ///< its least cost: kLanes, kept
    std::uint8_t* sums = nullptr;   ///< [d / kGroup] kSumsGroup: [column] kSumsColumn: [d] kLanes
    std::uint8_t* match = nullptr;  ///< matching costs, laid out like the sums
    int columns = 0;
    int disparities = 0;
    Penalties penalties;
};
/// How a path begins: nothing is owed, and nothing is worse than what lies beyond the last
/// disparity.
void begin_path(int disparities, std::uint8_t* state, std::uint8_t* least);
/// Follows the path from the left through the block; `sums` and `match` stay as they are.
void pass_right(const RowBlock& block);
/// The same, and `sums` become its costs. `match` is handed on to the two that come next;
/// processors that count bits quickly leave it alone.
void follow_right(const RowBlock& block);
/// Follows the path from the right, adds its costs to `sums` and turns them: column u of row v
/// comes to lie where row u of column v was, but one group of disparities before it (as `match`
/// does): the first group needs room before `sums`.
void follow_left(const RowBlock& block);

/// Where winners of 64 columns go: kLanes each, at any address.
struct WinnerRows {
    std::uint8_t* disparity = nullptr;
    std::uint8_t* cost = nullptr;
    std::uint8_t* cost_below = nullptr;
    std::uint8_t* cost_above = nullptr;
    std::uint8_t* second_cost = nullptr;
};
/// One row of 64 columns, side by side in the lanes.
struct ColumnStep {
    const std::uint8_t* left[kCensusBytes] = {};
    const std::uint8_t* right[kCensusBytes] = {};  ///< at the column of disparity 0
    const std::uint8_t* grey = nullptr;
    const std::uint8_t* grey_above = nullptr;
    const std::uint8_t* sums = nullptr;   ///< [d / kGroup] kSumsGroup: [d] kLanes, paths along rows
    const std::uint8_t* match = nullptr;  ///< laid out like the sums
    std::uint8_t* state = nullptr;        ///< path from above: (disparities + 1) * kLanes, kept
    std::uint8_t* least = nullptr;        ///< least cost of that path, kLanes, kept
    int disparities = 0;
    Penalties penalties;
};
void follow_columns(const ColumnStep& step, const WinnerRows& out);

}  // namespace surefoot::stereo::kernels
