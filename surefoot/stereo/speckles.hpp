// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/stereo/row_runs.hpp"

namespace surefoot::stereo {

/// Behind every search islands of fewer pixels go; pixels that differ by at most kSpeckleRange_px
/// hang together.
inline constexpr int kSpeckleSize_px = 100;
inline constexpr int kSpeckleRange_px = 2;

/// Removes small islands: pixels that hang together, each within `same_px` of the next along a row
/// or a column, and are fewer than `min_size` in all become NaN. Works on runs of each row (union
/// by root of their numbers), so that its cost grows with the edges in the image, not with its
/// pixels. Bands of rows are joined on their own first, then to each other over their borders.
class SpeckleFilter {
  public:
    void remove(Executor& executor, int min_size, double same_px, Image<float>& disparity_px);

  private:
    struct Run {
        int first = 0;
        int last = 0;    ///< inclusive
        int parent = 0;  ///< number of a run of the same island; its own = root
        int size = 0;    ///< pixels of the island, of roots
    };
    /// Some rows. Runs are numbered by their places in the band while it is alone, and then by the
    /// number of the band, shifted, and their places.
    struct Band {
        RowRuns in_row;
        std::vector<Run> runs;
        std::vector<int> row_first;  ///< place of the first run of each row, and the end
    };
    static constexpr int kBandRows = 32;
    static constexpr int kPlaceBits = 20;
    static constexpr int kMaxSide_px = 65000;  ///< 2047 bands of 32 rows of half as many runs fit

    Run& at(int number);
    [[nodiscard]] Band& band_of(int v);
    [[nodiscard]] int island_size(int run);
    void find_islands(int first_row, int last_row, const Image<float>& disparity_px, float same_px);
    void join_over_border(int v, const Image<float>& disparity_px, float same_px);
    void remove_islands(int first_row, int last_row, int min_size, Image<float>& disparity_px);

    std::vector<Band> bands_;
};

}  // namespace surefoot::stereo
