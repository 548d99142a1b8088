// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/semi_global_level.hpp"

#include <hwy/cache_control.h>

#include <algorithm>
#include <cstring>
#include <span>

#include "surefoot/core/assert.hpp"

namespace surefoot::stereo {
namespace {

static_assert(kBlockSide_px == kLanes && kRangeStep == kernels::kGroup);
constexpr int kHalf = kLanes / 2;

int groups_of(int disparities) {
    return (disparities + kernels::kGroup - 1) / kernels::kGroup;
}

kernels::WinnerRows winners_at(Winners& out, int u, int v) {
    return {out.disparity.row(v) + u,
            out.cost.row(v) + u,
            out.cost_below.row(v) + u,
            out.cost_above.row(v) + u,
            out.second_cost.row(v) + u};
}

/// Finds the winners of one row of a block, of which `count` columns lie in the image.
void find_winners(const kernels::ColumnStep& step, const kernels::WinnerRows& out, int count) {
    if (count == kLanes) return kernels::finish_row(step, out);
    std::uint8_t rows[5][kLanes];  // finish_row writes every element. NOLINT(*-member-init)
    kernels::finish_row(step, {rows[0], rows[1], rows[2], rows[3], rows[4]});
    const auto size = static_cast<std::size_t>(count);
    std::memcpy(out.disparity, rows[0], size);
    std::memcpy(out.cost, rows[1], size);
    std::memcpy(out.cost_below, rows[2], size);
    std::memcpy(out.cost_above, rows[3], size);
    std::memcpy(out.second_cost, rows[4], size);
}

/// Moves the state of a path from the disparities of a block to those of the next block.
void enter(const PathState& path, DisparityRange before, DisparityRange range) {
    kernels::enter_range(path.costs, before.begin, before.end, range.begin, range.end);
}

}  // namespace

void LevelPrior::resize(int width, int height, int disparities) {
    blocks_x_ = padded(width) / kLanes;
    const int blocks = blocks_x_ * (padded(height) / kLanes);
    disparities_ = disparities;
    block_size_ = static_cast<std::ptrdiff_t>(groups_of(disparities)) * kernels::kCostGroup;
    const auto size = static_cast<std::size_t>(blocks) * static_cast<std::size_t>(block_size_);
    rows_.resize_untouched(size);
    columns_.resize_untouched(size);
    searched_.resize(static_cast<std::size_t>(blocks));
    hopeful_.resize(static_cast<std::size_t>(4 * blocks));
}

std::ptrdiff_t LevelPrior::block_offset(int x, int y) const {
    return (static_cast<std::ptrdiff_t>(y) * blocks_x_ + x) * block_size_;
}

kernels::PriorBlock LevelPrior::quarter(
    const AlignedBytes& costs, int x, int y, int line, int lane) const {
    const auto searched = searched_[static_cast<std::size_t>(y / 2 * blocks_x_ + x / 2)];
    return {costs.data() + block_offset(x / 2, y / 2) + line * kernels::kCostLine + lane,
            searched.begin,
            searched.end,
            disparities_,
            kMaxPrior};
}

kernels::PriorBlock LevelPrior::rows_of(int x, int y) const {
    return quarter(rows_, x, y, kHalf * (y % 2), kHalf * (x % 2));
}

kernels::PriorBlock LevelPrior::columns_of(int x, int y) const {
    return quarter(columns_, x, y, kHalf * (x % 2), kHalf * (y % 2));
}

DisparityRange LevelPrior::hopeful(int x, int y) const {
    return hopeful_[static_cast<std::size_t>(2 * y * blocks_x_ + x)];
}

std::uint8_t* LevelPrior::row(int x, int y, int line) const {
    return rows_.data() + block_offset(x, y) + line * kernels::kCostLine;
}

void LevelPrior::finish_block(int x,
                              int y,
                              DisparityRange searched,
                              const DisparityRange hopeful[4]) {
    searched_[static_cast<std::size_t>(y * blocks_x_ + x)] = searched;
    for (int quarter = 0; quarter < 4; ++quarter) {
        const int row = 2 * y + quarter / 2;
        const int column = 2 * x + quarter % 2;
        hopeful_[static_cast<std::size_t>(2 * row * blocks_x_ + column)] = hopeful[quarter];
    }
    for (int d = searched.begin; d < searched.end; ++d) {
        const std::ptrdiff_t at = block_offset(x, y) + kernels::cost_at(d);
        kernels::transpose(
            rows_.data() + at, kernels::kCostLine, columns_.data() + at, kernels::kCostLine);
    }
}

DisparityRange LevelSearch::range(int block, int strip) const {
    if (strip < 0 || strip >= strips() || block < 0 || block >= blocks())
        return {0, config_.disparities};  // where paths start
    return ranges_[static_cast<std::size_t>(strip * blocks() + block)];
}

void LevelSearch::set_ranges() {
    ranges_.resize(static_cast<std::size_t>(strips() * blocks()));
    const auto step_down = [](int d) { return std::max(d, 0) / kRangeStep * kRangeStep; };
    for (int y = 0; y < strips(); ++y) {
        for (int x = 0; x < blocks(); ++x) {
            DisparityRange& range = ranges_[static_cast<std::size_t>(y * blocks() + x)];
            if (smaller_ == nullptr) {
                range = {0, config_.disparities};
                continue;
            }
            const DisparityRange hopeful = smaller_->hopeful(x, y);
            range = {step_down(2 * hopeful.begin - kRangeMargin),
                     std::min(config_.disparities,
                              step_down(2 * hopeful.end + kRangeMargin + kRangeStep - 1))};
        }
    }
}

void LevelSearch::resize(int strips_at_once) {
    left_census_.resize(width_, height_, 0);
    right_census_.resize(width_, height_, config_.disparities);
    sums_size_ =
        static_cast<std::ptrdiff_t>(groups_of(config_.disparities) + 1) * kernels::kCostGroup;
    const auto columns = static_cast<std::size_t>(padded(width_));
    const auto front = static_cast<std::size_t>(padded(config_.disparities));
    const std::size_t line = static_cast<std::size_t>(config_.disparities) * kLanes;
    for (Strip& strip : std::span(strips_).first(static_cast<std::size_t>(strips_at_once))) {
        strip.left.resize(columns * kernels::kCensusRow);
        strip.right.resize((columns + front) * kernels::kCensusRow);
        strip.grey.resize(columns * kLanes);
        strip.from_left.resize(blocks(), config_.disparities);
        strip.from_right.resize(1, config_.disparities);
        strip.sums.resize(static_cast<std::size_t>(2 * sums_size_));
        strip.prior_costs.resize(line);
        if (smaller_ == nullptr) std::memset(strip.prior_costs.data(), 0, line);
        if (prior_ == nullptr) continue;
        strip.row_sums.resize(line);
        strip.least_excess.resize(2 * line);
    }
    column_priors_.resize(static_cast<std::size_t>(blocks()) * line);
    if (smaller_ == nullptr)
        std::memset(column_priors_.data(), 0, static_cast<std::size_t>(blocks()) * line);
    from_above_.resize(blocks(), config_.disparities);
    from_below_.resize(blocks() * strips(), config_.disparities);
    for (int block = 0; block < blocks(); ++block) {
        for (const PathState& path :
             {from_above_.at(block), from_below_.at((strips() - 1) * blocks() + block)})
            kernels::begin_path(config_.disparities, path.costs, path.least);
    }
}

void LevelSearch::take_census(int strip) {
    for (int v = strip * kLanes; v < std::min(height_, (strip + 1) * kLanes); ++v) {
        left_census_.make_row(left_, width_, v);
        right_census_.make_row(right_, width_, v);
    }
}

/// Transposes census words and grey levels of a strip, so that rows lie in the lanes.
void LevelSearch::turn_strip(const Strip& s) {
    const int v = s.index * kLanes;
    const int front = right_census_.front;
    const auto turn = [&](const std::uint8_t* rows, std::ptrdiff_t stride, std::uint8_t* out) {
        kernels::transpose(rows, stride, out, kernels::kCensusRow);
    };
    for (int u = 0; u < padded(width_); u += kLanes) {
        kernels::transpose(left_.row(v) + u, left_.stride, s.grey.data() + u * kLanes, kLanes);
        for (int byte = 0; byte < kCensusBytes; ++byte) {
            turn(left_census_.row(byte, v) + u,
                 left_census_.stride,
                 s.left.data() + u * kernels::kCensusRow + byte * kLanes);
        }
    }
    for (int u = -front; u < padded(width_); u += kLanes) {
        for (int byte = 0; byte < kCensusBytes; ++byte) {
            turn(right_census_.row(byte, v) + u,
                 right_census_.stride,
                 s.right.data() + (u + front) * kernels::kCensusRow + byte * kLanes);
        }
    }
}

kernels::RowBlock LevelSearch::row_block(const Strip& s, int block) const {
    const int u = block * kLanes;
    const DisparityRange searched = range(block, s.index);
    kernels::RowBlock rows;
    rows.left = s.left.data() + u * kernels::kCensusRow;
    rows.right = s.right.data() + (u + right_census_.front) * kernels::kCensusRow;
    rows.grey = s.grey.data() + u * kLanes;
    rows.grey_before = rows.grey - (block > 0 ? kLanes : 0);
    if (smaller_ != nullptr) rows.prior = smaller_->columns_of(block, s.index);
    rows.prior_costs = s.prior_costs.data();
    rows.columns = std::min(kLanes, width_ - u);
    rows.begin = searched.begin;
    rows.end = searched.end;
    rows.penalties = penalties_;
    return rows;
}

/// Runs the paths from the left once and stores only their state at each block. The costs of a
/// whole strip would not fit into a cache.
void LevelSearch::pass_strip(const Strip& s) {
    turn_strip(s);
    const PathState start = s.from_left.at(0);
    kernels::begin_path(config_.disparities, start.costs, start.least);
    for (int block = 0; block < blocks(); ++block) {
        const PathState here = s.from_left.at(block);
        enter(here, range(block - 1, s.index), range(block, s.index));
        if (block + 1 == blocks()) break;
        s.from_left.copy(block, block + 1);
        kernels::RowBlock rows = row_block(s, block);
        const PathState path = s.from_left.at(block + 1);
        rows.state = path.costs;
        rows.least = path.least;
        kernels::pass_right(rows);
    }
    const PathState end = s.from_right.at(0);
    kernels::begin_path(config_.disparities, end.costs, end.least);
}

/// The row `v` of a block; `v_before` is the row before it on the path.
kernels::ColumnStep LevelSearch::column_step(int block, int v, int v_before) const {
    const int u = block * kLanes;
    const DisparityRange searched = range(block, v / kLanes);
    kernels::ColumnStep step;
    for (int byte = 0; byte < kCensusBytes; ++byte) {
        step.left[byte] = left_census_.row(byte, v) + u;
        step.right[byte] = right_census_.row(byte, v) + u;
    }
    step.grey = left_.row(v) + u;
    step.grey_before = left_.row(std::clamp(v_before, 0, height_ - 1)) + u;
    step.begin = searched.begin;
    step.end = searched.end;
    step.penalties = penalties_;
    return step;
}

/// Runs the paths from below through 64 columns and stores only their state at each block.
void LevelSearch::pass_up(int block) {
    std::uint8_t* const priors =
        column_priors_.data() + static_cast<std::ptrdiff_t>(block) * config_.disparities * kLanes;
    for (int strip = strips() - 1; strip >= 0; --strip) {
        const int at = strip * blocks() + block;
        enter(from_below_.at(at), range(block, strip + 1), range(block, strip));
        if (strip == 0) break;
        from_below_.copy(at, at - blocks());
        const PathState path = from_below_.at(at - blocks());
        kernels::PriorBlock prior;
        if (smaller_ != nullptr) prior = smaller_->rows_of(block, strip);
        const int begin = strip * kLanes;
        int spread = -1;
        for (int v = std::min(height_, begin + kLanes) - 1; v >= begin; --v) {
            kernels::ColumnStep step = column_step(block, v, v + 1);
            const int line = (v - begin) / 2;
            if (smaller_ != nullptr && line != spread)
                kernels::spread_prior(prior, line, step.begin, step.end, priors);
            spread = line;
            step.prior_costs = priors;
            step.state = path.costs;
            step.least = path.least;
            kernels::pass_row(step);
        }
    }
}

/// Runs both paths along the rows through 64 x 64 pixels. Needs the result of the block to the
/// right.
void LevelSearch::follow_rows(const Strip& s, int block) {
    kernels::RowBlock rows = row_block(s, block);
    rows.sums = s.sums.data() + kernels::kCostGroup;
    rows.match = rows.sums + sums_size_;
    const PathState from_left = s.from_left.at(block);
    rows.state = from_left.costs;
    rows.least = from_left.least;
    kernels::follow_right(rows);
    const bool at_edge = block + 1 == blocks();
    rows.grey_before = rows.grey + (at_edge ? rows.columns - 1 : kLanes) * kLanes;
    const PathState from_right = s.from_right.at(0);
    enter(from_right, range(block + 1, s.index), range(block, s.index));
    rows.state = from_right.costs;
    rows.least = from_right.least;
    kernels::follow_left(rows);
}

/// Prefetches the data that one row of a block reads and writes. Rows lie too far apart for the
/// processor to predict the next row.
void LevelSearch::prefetch_row(int u, int v) const {
    hwy::Prefetch(left_.row(v) + u);
    if (winners_ == nullptr) return;
    const auto [disparity, cost, cost_below, cost_above, second_cost] = winners_at(*winners_, u, v);
    const int last = std::min(kLanes, width_ - u) - 1;
    for (std::uint8_t* const row : {disparity, cost, cost_below, cost_above, second_cost}) {
        hwy::Prefetch(row);
        hwy::Prefetch(row + last);
    }
}

/// Runs the paths from below and from above through a block and takes its result. Needs the result
/// of the block above, and the row paths of this block.
void LevelSearch::follow_columns(const Strip& s, int block) {
    const int u = block * kLanes;
    const int begin = s.index * kLanes;
    const int end = std::min(height_, begin + kLanes);
    const auto step_of = [&](int v, int v_before, const PathState& path) {
        kernels::ColumnStep step = column_step(block, v, v_before);
        step.sums = s.sums.data() + (v - begin) * kernels::kCostLine;
        step.match = step.sums + sums_size_;
        step.state = path.costs;
        step.least = path.least;
        return step;
    };
    const PathState below = from_below_.at(s.index * blocks() + block);
    for (int v = end - 1; v >= begin; --v) kernels::follow_row(step_of(v, v + 1, below));
    const PathState above = from_above_.at(block);
    enter(above, range(block, s.index - 1), range(block, s.index));
    const std::ptrdiff_t half = static_cast<std::ptrdiff_t>(config_.disparities) * kLanes;
    if (prior_ != nullptr)
        std::memset(s.least_excess.data(), 255, static_cast<std::size_t>(2 * half));
    for (int v = begin; v < end; ++v) {
        prefetch_row(u, std::min(v + 1, end - 1));
        const kernels::ColumnStep step = step_of(v, v - 1, above);
        if (winners_ != nullptr)
            find_winners(step, winners_at(*winners_, u, v), std::min(kLanes, width_ - u));
        if (prior_ == nullptr) continue;
        kernels::PriorRow row;
        row.costs = prior_->row(block, s.index, v - begin) + kernels::cost_at(step.begin);
        row.least_excess = s.least_excess.data() + (v - begin >= kHalf ? half : 0);
        row.sums = s.row_sums.data();
        row.shift = kPriorShift;
        kernels::finish_prior_row(step, row);
    }
}

/// Completes the prior of a block: its columns, and which disparities are hopeful in its quarters.
void LevelSearch::give_prior(const Strip& s, int block) {
    const DisparityRange searched = range(block, s.index);
    DisparityRange hopeful[4];
    for (int quarter = 0; quarter < 4; ++quarter) {
        hopeful[quarter] = {config_.disparities, 0};
        const int lane = kHalf * (quarter % 2);
        const int columns = std::min(kHalf, width_ - block * kLanes - lane);
        const std::uint8_t* excess =
            s.least_excess.data() +
            static_cast<std::ptrdiff_t>(quarter / 2) * config_.disparities * kLanes + lane;
        for (int d = searched.begin; d < searched.end; ++d, excess += kLanes) {
            if (columns <= 0 || *std::min_element(excess, excess + columns) >= kHopeless) continue;
            hopeful[quarter].begin = std::min(hopeful[quarter].begin, d);
            hopeful[quarter].end = d + 1;
        }
    }
    prior_->finish_block(block, s.index, searched, hopeful);
}

/// Processes blocks from right to left, directly behind the strip above.
void LevelSearch::follow_strip(const Strip& s) {
    for (int done = 0; done < blocks(); ++done) {
        const int block = blocks() - 1 - done;
        follow_rows(s, block);
        if (s.index > 0) progress_.wait_for(s.index - 1, done + 1);
        follow_columns(s, block);
        progress_.block_is_done(s.index);
        if (prior_ != nullptr) give_prior(s, block);
    }
}

void LevelSearch::search(const SemiGlobalConfig& config,
                         ImageView<const std::uint8_t> left,
                         ImageView<const std::uint8_t> right,
                         const LevelPrior* smaller,
                         Executor& executor,
                         Winners* winners,
                         LevelPrior* prior) {
    config_ = config;
    penalties_ = {static_cast<std::uint8_t>(config.slope_penalty),
                  static_cast<std::uint8_t>(config.jump_penalty),
                  static_cast<std::uint8_t>(config.min_jump_penalty),
                  config.contrast_shift};
    width_ = left.width;
    height_ = left.height;
    smaller_ = smaller;
    winners_ = winners;
    prior_ = prior;
    const int at_once = std::clamp(executor.threads(), 1, std::min(strips(), kMaxStrips));
    left_.copy(left);
    right_.copy(right);
    set_ranges();
    resize(at_once);
    progress_.begin(strips());
    if (winners != nullptr) winners->resize(left.width, left.height);
    if (prior != nullptr) prior->resize(left.width, left.height, config.disparities);
    executor.parallel_for(strips(), [&](int strip) { take_census(strip); });
    executor.parallel_for(blocks(), [&](int block) { pass_up(block); });
    executor.parallel_for(at_once, [&](int k) {
        Strip& strip = strips_[k];
        for (;;) {
            strip.index = progress_.take_strip();
            if (strip.index >= strips()) return;
            pass_strip(strip);
            follow_strip(strip);
        }
    });
}

}  // namespace surefoot::stereo
