// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "surefoot/stereo/census_window.hpp"

/// The inner loops of SemiGlobalSearch. Widths and counts are multiples of kLanes. Every row of 64
/// bytes is aligned to 64 bytes.
namespace surefoot::stereo::kernels {

inline constexpr int kLanes = 64;
/// Bytes of the census words at one column of a strip: kCensusBytes rows of kLanes.
inline constexpr int kCensusRow = kCensusBytes * kLanes;

/// Number of disparities in a group. The path sums of 64 x 64 pixels are stored in such groups,
/// column by column (row by row after the transposition). So loops over disparities, and the
/// transposition of one group, use only a few memory pages.
inline constexpr int kGroup = 8;
/// Sizes [bytes] of a column and of a group, with one disparity and one column of padding. Without
/// padding, addresses a power of two apart would share their cache lines.
inline constexpr int kSumsColumn = (kGroup + 1) * kLanes;
inline constexpr int kSumsGroup = (kLanes + 1) * kSumsColumn;

struct Penalties {
    std::uint8_t slope = 0;
    std::uint8_t jump = 0;
    std::uint8_t min_jump = 0;
    int contrast_shift = 0;
};

/// Computes the census bytes of one row, in the order that makes counting differing bits fastest.
/// `grey` points at the row's first pixel in an image with a border of kCensusReach. `out[byte]`
/// receives `width` values.
void census(const std::uint8_t* grey,
            std::ptrdiff_t stride,
            int width,
            std::uint8_t* const out[kCensusBytes]);

/// Transposes 64 x 64 bytes: out[x][y] = in[y][x].
void transpose(const std::uint8_t* in,
               std::ptrdiff_t in_stride,
               std::uint8_t* out,
               std::ptrdiff_t out_stride);

/// A block of up to 64 columns of 64 rows; the rows lie side by side in the lanes.
struct RowBlock {
    const std::uint8_t* left = nullptr;   ///< kCensusRow bytes per column
    const std::uint8_t* right = nullptr;  ///< `disparities` more columns precede column 0
    const std::uint8_t* grey = nullptr;   ///< kLanes bytes per column
    /// Grey values of the previous column on the path; at the image edge, of its first column.
    const std::uint8_t* grey_before = nullptr;
    std::uint8_t* state = nullptr;  ///< path costs, (disparities + 1) * kLanes bytes; updated
    std::uint8_t* least = nullptr;  ///< least path cost, kLanes bytes; updated
    std::uint8_t* sums = nullptr;   ///< groups (kSumsGroup) of columns (kSumsColumn) of disparities
    std::uint8_t* match = nullptr;  ///< matching costs, laid out like the sums
    int columns = 0;
    int disparities = 0;
    Penalties penalties;
};
/// Starts a path: all costs are 0, and the entry beyond the last disparity is larger than any real
/// cost.
void begin_path(int disparities, std::uint8_t* state, std::uint8_t* least);
/// Runs the path from the left through the block without changing `sums` and `match`.
void pass_right(const RowBlock& block);
/// Runs the path from the left and writes its costs to `sums`. Also stores the matching costs in
/// `match` for the next two paths, except on processors that count bits quickly.
void follow_right(const RowBlock& block);
/// Runs the path from the right, adds its costs to `sums` and transposes them. Column u of row v
/// moves to row u of column v, one group of disparities earlier. `match` moves in the same way. The
/// first group needs room before `sums`.
void follow_left(const RowBlock& block);

/// Output of the winners of 64 columns: kLanes values in each array, at any alignment.
struct WinnerRows {
    std::uint8_t* disparity = nullptr;
    std::uint8_t* cost = nullptr;
    std::uint8_t* cost_below = nullptr;
    std::uint8_t* cost_above = nullptr;
    std::uint8_t* second_cost = nullptr;
};
/// Input for one row of 64 columns, which lie side by side in the lanes.
struct ColumnStep {
    const std::uint8_t* left[kCensusBytes] = {};
    const std::uint8_t* right[kCensusBytes] = {};  ///< pointers to the column of disparity 0
    const std::uint8_t* grey = nullptr;
    const std::uint8_t* grey_above = nullptr;
    const std::uint8_t* sums = nullptr;   ///< groups (kSumsGroup) of sums of the paths along rows
    const std::uint8_t* match = nullptr;  ///< laid out like the sums
    std::uint8_t* state = nullptr;        ///< path from above, (disparities + 1) * kLanes; updated
    std::uint8_t* least = nullptr;        ///< least cost of that path, kLanes bytes; updated
    int disparities = 0;
    Penalties penalties;
};
void follow_columns(const ColumnStep& step, const WinnerRows& out);

}  // namespace surefoot::stereo::kernels
