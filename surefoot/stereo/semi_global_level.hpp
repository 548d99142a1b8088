// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/stereo/semi_global.hpp"
#include "surefoot/stereo/semi_global_buffers.hpp"

namespace surefoot::stereo {

/// Disparities [begin, end).
struct DisparityRange {
    int begin = 0;
    int end = 0;
};

/// Priors and hopeful disparities that a level passes to the level of twice its size. Its blocks
/// have 64 x 64 pixels of the giving level; each helps 2 x 2 blocks of the receiving level.
class LevelPrior {
  public:
    void resize(int width, int height, int disparities);

    /// Priors of the receiving level's block (x, y), line by line along rows or columns.
    [[nodiscard]] kernels::PriorBlock rows_of(int x, int y) const;
    [[nodiscard]] kernels::PriorBlock columns_of(int x, int y) const;
    /// Disparities of the giving level that are not hopeless in the receiving level's block (x, y).
    [[nodiscard]] DisparityRange hopeful(int x, int y) const;

    // For the giving level.
    /// Costs of row `line` of the block (x, y) from disparity 0 on, in groups.
    [[nodiscard]] std::uint8_t* row(int x, int y, int line) const;
    /// Call once the rows of the block (x, y) are complete. `searched`: disparities of the rows.
    /// `hopeful`: see hopeful(), for the quarters of the block row by row.
    void finish_block(int x, int y, DisparityRange searched, const DisparityRange hopeful[4]);

  private:
    [[nodiscard]] std::ptrdiff_t block_offset(int x, int y) const;
    [[nodiscard]] kernels::PriorBlock quarter(
        const AlignedBytes& costs, int x, int y, int line, int lane) const;

    int blocks_x_ = 0;
    int disparities_ = 0;
    std::ptrdiff_t block_size_ = 0;
    AlignedBytes rows_;
    AlignedBytes columns_;
    std::vector<DisparityRange> searched_;
    std::vector<DisparityRange> hopeful_;
};

/// The fast search of one level. It gives either winners or a prior for the next level.
class LevelSearch {
  public:
    void search(const SemiGlobalConfig& config,
                ImageView<const std::uint8_t> left,
                ImageView<const std::uint8_t> right,
                const LevelPrior* smaller,
                Executor& executor,
                Winners* winners,
                LevelPrior* prior);

  private:
    /// Data of 64 rows during their search, column by column with the rows in the lanes.
    struct Strip {
        int index = 0;  ///< number of the strip in the image
        AlignedBytes left;
        AlignedBytes right;
        AlignedBytes grey;
        PathStates from_left;  ///< state at the start of each block of 64 columns
        PathStates from_right;
        AlignedBytes sums;  ///< of one block, then matching costs; a free group before each part
        AlignedBytes prior_costs;
        AlignedBytes row_sums;      ///< scratch of a row, if the level gives a prior
        AlignedBytes least_excess;  ///< see PriorRow, for the upper and the lower half of a block
    };
    /// Largest number of strips that are processed at the same time, one per thread. The data of a
    /// strip stay in the cache until they are used.
    static constexpr int kMaxStrips = 6;

    [[nodiscard]] int blocks() const { return padded(width_) / kLanes; }
    [[nodiscard]] int strips() const { return padded(height_) / kLanes; }
    [[nodiscard]] DisparityRange range(int block, int strip) const;
    void resize(int strips_at_once);
    void set_ranges();
    void take_census(int strip);
    void turn_strip(const Strip& s);
    void pass_strip(const Strip& s);
    void pass_up(int block);
    void follow_rows(const Strip& s, int block);
    void follow_columns(const Strip& s, int block);
    void give_prior(const Strip& s, int block);
    void follow_strip(const Strip& s);
    [[nodiscard]] kernels::RowBlock row_block(const Strip& s, int block) const;
    [[nodiscard]] kernels::ColumnStep column_step(int block, int v, int v_before) const;
    void prefetch_row(int u, int v) const;

    SemiGlobalConfig config_;
    kernels::Penalties penalties_;
    int width_ = 0;
    int height_ = 0;
    const LevelPrior* smaller_ = nullptr;
    Winners* winners_ = nullptr;
    LevelPrior* prior_ = nullptr;
    Bordered left_;
    Bordered right_;
    CensusPlanes left_census_;
    CensusPlanes right_census_;
    Strip strips_[kMaxStrips];  ///< one for each thread that works at the same time
    std::ptrdiff_t sums_size_ = 0;
    Progress progress_;
    std::vector<DisparityRange> ranges_;
    PathStates from_above_;       ///< one state per 64 columns
    PathStates from_below_;       ///< states at the lower end of each block
    AlignedBytes column_priors_;  ///< scratch per 64 columns
};

}  // namespace surefoot::stereo
