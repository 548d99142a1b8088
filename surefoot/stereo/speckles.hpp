// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

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
/// pixels.
class SpeckleFilter {
  public:
    void remove(int min_size, double same_px, Image<float>& disparity_px);

  private:
    struct Run {
        int first = 0;
        int last = 0;    ///< inclusive
        int parent = 0;  ///< index of a run of the same island; its own = root
        int size = 0;    ///< pixels of the island, of roots
    };
    int root_of(int run);
    void join(int a, int b);
    void connect(const Image<float>& disparity_px, int v, float same_px);

    RowRuns in_row_;
    std::vector<Run> runs_;
    std::vector<int> row_first_;  ///< index of the first run of each row, and the end
};

}  // namespace surefoot::stereo
