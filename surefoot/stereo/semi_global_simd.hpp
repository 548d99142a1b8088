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

/// Number of disparities in a group. The costs of 64 x 64 pixels are stored in such groups, line by
/// line (a line is a column, or a row after the transposition). So loops over disparities, and the
/// transposition of one group, use only a few memory pages.
inline constexpr int kGroup = 8;
/// Sizes [bytes] of a line and of a group, with one disparity and one line of padding. Without
/// padding, addresses a power of two apart would share their cache lines.
inline constexpr int kCostLine = (kGroup + 1) * kLanes;
inline constexpr int kCostGroup = (kLanes + 1) * kCostLine;

/// Offset of a disparity in the costs of a line.
constexpr std::ptrdiff_t cost_at(int disparity) {
    return static_cast<std::ptrdiff_t>(disparity / kGroup) * kCostGroup +
           static_cast<std::ptrdiff_t>(disparity % kGroup) * kLanes;
}

struct Penalties {
    std::uint8_t slope = 0;
    std::uint8_t jump = 0;
    std::uint8_t min_jump = 0;
    int contrast_shift = 0;
};

/// Computes the census bytes of one row. `grey` points at the row's first pixel in an image with a
/// border of kCensusReach. `out[byte]` receives `width` values.
void census(const std::uint8_t* grey,
            std::ptrdiff_t stride,
            int width,
            std::uint8_t* const out[kCensusBytes]);

/// Transposes 64 x 64 bytes: out[x][y] = in[y][x].
void transpose(const std::uint8_t* in,
               std::ptrdiff_t in_stride,
               std::uint8_t* out,
               std::ptrdiff_t out_stride);

/// The priors that the smaller level gives to a block of 64 x 64 pixels: one line of 32 bytes for
/// two lines of the block.
struct PriorBlock {
    const std::uint8_t* costs = nullptr;  ///< line 0, lane 0 of disparity 0; nullptr = no prior
    int begin = 0;                        ///< first disparity of the smaller level that has costs
    int end = 0;
    int disparities = 0;       ///< of the smaller level
    std::uint8_t outside = 0;  ///< prior of disparities outside [begin, end)
};

/// Writes the priors of the disparities [begin, end) of the block's lines 2 line and 2 line + 1,
/// kLanes bytes each. An odd disparity takes the mean of its two neighbours.
void spread_prior(const PriorBlock& block, int line, int begin, int end, std::uint8_t* out);

/// A block of up to 64 columns of 64 rows; the rows lie side by side in the lanes. The disparities
/// [begin, end) are searched; begin is a multiple of kGroup.
struct RowBlock {
    const std::uint8_t* left = nullptr;   ///< kCensusRow bytes per column
    const std::uint8_t* right = nullptr;  ///< at least `end` columns precede column 0
    const std::uint8_t* grey = nullptr;   ///< kLanes bytes per column
    /// Grey values of the previous column on the path; at the image edge, of its first column.
    const std::uint8_t* grey_before = nullptr;
    PriorBlock prior;
    /// (end - begin) * kLanes bytes: scratch, or zeros if there is no prior.
    std::uint8_t* prior_costs = nullptr;
    std::uint8_t* state = nullptr;  ///< costs of disparity 0 and above; updated
    std::uint8_t* least = nullptr;  ///< least path cost, kLanes bytes; updated
    std::uint8_t* sums = nullptr;   ///< groups (kCostGroup) from disparity `begin` on, by column
    std::uint8_t* match = nullptr;  ///< matching costs, laid out like the sums
    int columns = 0;
    int begin = 0;
    int end = 0;
    Penalties penalties;
};
/// Starts a path: all costs are 0.
void begin_path(int disparities, std::uint8_t* state, std::uint8_t* least);
/// Lets a path with costs for [old_begin, old_end) enter a block that searches [begin, end). New
/// disparities, and the one beyond the last, get a cost that is larger than any real cost.
void enter_range(std::uint8_t* state, int old_begin, int old_end, int begin, int end);
/// Runs the path from the left through the block without changing `sums` and `match`.
void pass_right(const RowBlock& block);
/// Runs the path from the left and writes its costs to `sums` and the matching costs to `match`.
void follow_right(const RowBlock& block);
/// Runs the path from the right, adds its costs to `sums`, and transposes `sums` and `match`.
/// Column u of row v moves to row u of column v, one group of disparities earlier. The first group
/// needs room before it.
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
    const std::uint8_t* prior_costs = nullptr;     ///< from spread_prior, or zeros
    const std::uint8_t* grey = nullptr;
    const std::uint8_t* grey_before = nullptr;  ///< of the previous row on the path
    std::uint8_t* sums = nullptr;               ///< groups from disparity `begin` on
    const std::uint8_t* match = nullptr;        ///< laid out like the sums
    std::uint8_t* state = nullptr;              ///< as in RowBlock
    std::uint8_t* least = nullptr;
    int begin = 0;
    int end = 0;
    Penalties penalties;
};
/// Runs a path through the row. Computes the matching costs from census words and priors, and
/// changes neither `sums` nor `match`.
void pass_row(const ColumnStep& step);
/// Runs a path through the row and adds its costs to `sums`.
void follow_row(const ColumnStep& step);
/// Runs the last path through the row and finds the winners.
void finish_row(const ColumnStep& step, const WinnerRows& out);

/// Priors that a level passes to the level of twice its size, for one row of 64 columns.
struct PriorRow {
    std::uint8_t* costs = nullptr;         ///< disparity `begin`, in groups
    std::uint8_t* least_excess = nullptr;  ///< least difference to the least sum, kLanes bytes per
                                           ///< disparity from `begin` on; updated
    std::uint8_t* sums = nullptr;          ///< scratch of (end - begin) * kLanes bytes
    int shift = 0;
};
/// Runs the last path through the row and writes the priors: (sum - least sum) >> shift.
void finish_prior_row(const ColumnStep& step, const PriorRow& out);

}  // namespace surefoot::stereo::kernels
