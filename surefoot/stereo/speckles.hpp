// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/stereo/row_runs.hpp"

namespace surefoot::stereo {

/// Every search removes islands with fewer pixels than this. Neighbours that differ by at most
/// kSpeckleRange_px [px] belong to the same island.
inline constexpr int kSpeckleSize_px = 100;
inline constexpr int kSpeckleRange_px = 2;

/// Removes small islands: groups of fewer than `min_size` pixels become NaN. Neighbours along a row
/// or column belong together if they differ by at most `same_px`. Works on runs of each row with
/// union-find, so the cost grows mainly with the number of edges in the image. Joins runs within
/// bands of rows first, then across the borders of the bands.
class SpeckleFilter {
  public:
    void remove(Executor& executor, int min_size, double same_px, Image<float>& disparity_px);

  private:
    struct Run {
        int first = 0;
        int last = 0;    ///< inclusive
        int parent = 0;  ///< number of a run of the same island; its own number = root
        int size = 0;    ///< number of pixels of the island; valid for roots
    };
    /// A band of rows. The number of a run is first its index in the band. Before bands are joined,
    /// the shifted number of the band is added.
    struct Band {
        RowRuns in_row;
        std::vector<Run> runs;
        std::vector<int> row_first;  ///< index of the first run of each row, and the end
    };
    static constexpr int kBandRows = 32;
    static constexpr int kPlaceBits = 20;
    static constexpr int kMaxSide_px = 65000;  ///< run numbers hold 2047 bands of at most 2^20 runs

    Run& at(int number);
    [[nodiscard]] Band& band_of(int v);
    [[nodiscard]] int island_size(int run);
    void find_islands(int first_row, int last_row, const Image<float>& disparity_px, float same_px);
    void join_over_border(int v, const Image<float>& disparity_px, float same_px);
    void remove_islands(int first_row, int last_row, int min_size, Image<float>& disparity_px);

    std::vector<Band> bands_;
};

}  // namespace surefoot::stereo
