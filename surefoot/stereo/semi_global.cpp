// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/semi_global.hpp"

#include <hwy/cache_control.h>

#include <algorithm>
#include <cstring>
#include <mutex>
#include <new>
#include <span>
#include <utility>
#include <vector>

#include "surefoot/core/assert.hpp"
#include "surefoot/stereo/semi_global_kernels.hpp"

namespace surefoot::stereo {
namespace {

using kernels::kLanes;

constexpr int padded(int count) {
    return (count + kLanes - 1) / kLanes * kLanes;
}

/// Bytes at addresses that whole registers like. Grows, never shrinks.
class AlignedBytes {
  public:
    AlignedBytes() = default;
    AlignedBytes(const AlignedBytes&) = delete;
    AlignedBytes& operator=(const AlignedBytes&) = delete;
    ~AlignedBytes() { release(); }

    void resize(std::size_t size) {
        if (size <= size_) return;
        release();
        bytes_ = static_cast<std::uint8_t*>(::operator new(size, kAlignment));
        size_ = size;
        std::memset(bytes_, 0, size);
    }
    [[nodiscard]] std::uint8_t* data() const noexcept { return bytes_; }

  private:
    static constexpr std::align_val_t kAlignment{kLanes};
    void release() {
        if (bytes_ != nullptr) ::operator delete(bytes_, kAlignment);
        bytes_ = nullptr;
    }
    std::uint8_t* bytes_ = nullptr;
    std::size_t size_ = 0;
};

/// An image with a border that repeats its edge, rows aligned.
struct Bordered {
    AlignedBytes bytes;
    std::ptrdiff_t stride = 0;

    [[nodiscard]] std::uint8_t* row(int v) const {
        return bytes.data() + (v + kCensusReach_v) * stride + kLanes;
    }
    void copy(ImageView<const std::uint8_t> image) {
        stride = padded(image.width) + 2 * kLanes;
        bytes.resize(static_cast<std::size_t>(stride) *
                     static_cast<std::size_t>(padded(image.height) + 2 * kCensusReach_v));
        for (int v = -kCensusReach_v; v < image.height + kCensusReach_v; ++v) {
            const std::uint8_t* const in = image.row(std::clamp(v, 0, image.height - 1));
            std::uint8_t* const out = row(v);
            std::memcpy(out, in, static_cast<std::size_t>(image.width));
            std::memset(out - kLanes, in[0], kLanes);
            std::memset(out + image.width,
                        in[image.width - 1],
                        static_cast<std::size_t>(stride - kLanes - image.width));
        }
    }
};

/// Census words of an image, byte planes row by row. `front` columns repeat the first one.
struct CensusPlanes {
    AlignedBytes bytes;
    std::ptrdiff_t stride = 0;
    std::ptrdiff_t plane = 0;
    int front = 0;

    [[nodiscard]] std::uint8_t* row(int byte, int v) const {
        return bytes.data() + byte * plane + v * stride + front;
    }
    void resize(int width, int height, int front_columns) {
        front = padded(front_columns);
        stride = front + padded(width) + kLanes;
        plane = stride * padded(height);
        bytes.resize(static_cast<std::size_t>(kCensusBytes * plane));
    }
    void make_row(const Bordered& image, int width, int v) {
        std::uint8_t* const rows[kCensusBytes] = {row(0, v), row(1, v), row(2, v), row(3, v)};
        kernels::census(image.row(v), image.stride, padded(width), rows);
        for (std::uint8_t* const out : rows)
            std::memset(out - front, out[0], static_cast<std::size_t>(front));
    }
};

/// A path at one place of its way: costs per disparity and one row more, and the least of them.
struct PathState {
    std::uint8_t* costs = nullptr;
    std::uint8_t* least = nullptr;
};

/// Paths at many places.
struct PathStates {
    AlignedBytes bytes;
    std::ptrdiff_t stride = 0;

    void resize(int count, int disparities) {
        stride = static_cast<std::ptrdiff_t>(disparities + 2) * kLanes;
        bytes.resize(static_cast<std::size_t>(count * stride));
    }
    [[nodiscard]] PathState at(int index) const {
        std::uint8_t* const costs = bytes.data() + index * stride;
        return {costs, costs + stride - kLanes};
    }
    void copy(int from, int to) const {
        std::memcpy(at(to).costs, at(from).costs, static_cast<std::size_t>(stride));
    }
};

/// What 64 rows need, column by column with the rows in the lanes.
struct Strip {
    AlignedBytes left;
    AlignedBytes right;
    AlignedBytes grey;
    PathStates from_left;  ///< as it enters each block of 64 columns
    PathStates from_right;
};

/// The costs of 64 x 64 pixels, as many as work at the same time. The one used last is handed out
/// first: it lies in the cache of its processor.
class BlockPool {
  public:
    void resize(std::size_t count, std::size_t size) {
        if (blocks_.size() != count) blocks_ = std::vector<AlignedBytes>(count);
        free_.clear();
        for (AlignedBytes& block : blocks_) {
            block.resize(size);
            free_.push_back(block.data());
        }
    }
    [[nodiscard]] std::uint8_t* take() {
        const std::lock_guard lock(mutex_);
        std::uint8_t* const block = free_.back();
        free_.pop_back();
        return block;
    }
    void give_back(std::uint8_t* block) {
        const std::lock_guard lock(mutex_);
        free_.push_back(block);
    }

  private:
    std::mutex mutex_;
    std::vector<AlignedBytes> blocks_;
    std::vector<std::uint8_t*> free_;
};

/// Strips of 64 rows that are worked on together, at most. One for each thread: what is made of a
/// strip stays in the cache until it has been used.
constexpr int kMaxStrips = 6;

kernels::WinnerRows winners_at(Winners& out, int u, int v) {
    return {out.disparity.row(v) + u,
            out.cost.row(v) + u,
            out.cost_below.row(v) + u,
            out.cost_above.row(v) + u,
            out.second_cost.row(v) + u};
}

/// One row of a block, of which `count` columns lie in the image.
void follow_row(const kernels::ColumnStep& step, const kernels::WinnerRows& out, int count) {
    if (count == kLanes) return kernels::follow_columns(step, out);
    std::uint8_t rows[5][kLanes];  // all of it is written. NOLINT(*-member-init)
    kernels::follow_columns(step, {rows[0], rows[1], rows[2], rows[3], rows[4]});
    const auto size = static_cast<std::size_t>(count);
    std::memcpy(out.disparity, rows[0], size);
    std::memcpy(out.cost, rows[1], size);
    std::memcpy(out.cost_below, rows[2], size);
    std::memcpy(out.cost_above, rows[3], size);
    std::memcpy(out.second_cost, rows[4], size);
}

}  // namespace

struct SemiGlobalSearch::Workspace {
    SemiGlobalConfig config;
    kernels::Penalties penalties;
    int width = 0;
    int height = 0;
    Bordered left;
    Bordered right;
    CensusPlanes left_census;
    CensusPlanes right_census;
    int strips_at_once = 0;
    Strip strips[kMaxStrips];
    BlockPool pool;  ///< sums, and as many matching costs behind them; a free group before each
    std::ptrdiff_t sums_size = 0;
    PathStates from_above;  ///< per 64 columns

    [[nodiscard]] int column_blocks() const { return padded(width) / kLanes; }

    void resize();
    void take_census(int strip);
    void turn_strip(int strip);
    void pass_strip(int strip);
    void follow_block(int strip, int block, Winners& out);
    void follow_columns(int strip, int block, const std::uint8_t* sums, Winners& out);
    void call_row(int u, int v, Winners& out) const;
    [[nodiscard]] kernels::RowBlock row_block(int strip, int block) const;
};

void SemiGlobalSearch::Workspace::resize() {
    left_census.resize(width, height, 0);
    right_census.resize(width, height, config.disparities);
    const int groups = (config.disparities + kernels::kGroup - 1) / kernels::kGroup;
    sums_size = static_cast<std::ptrdiff_t>(groups + 1) * kernels::kSumsGroup;
    pool.resize(static_cast<std::size_t>(strips_at_once), static_cast<std::size_t>(2 * sums_size));
    const auto columns = static_cast<std::size_t>(padded(width));
    const auto front = static_cast<std::size_t>(padded(config.disparities));
    for (Strip& strip : std::span(strips).first(static_cast<std::size_t>(strips_at_once))) {
        strip.left.resize(columns * kernels::kCensusRow);
        strip.right.resize((columns + front) * kernels::kCensusRow);
        strip.grey.resize(columns * kLanes);
        strip.from_left.resize(column_blocks() + 1, config.disparities);
        strip.from_right.resize(1, config.disparities);
    }
    from_above.resize(column_blocks(), config.disparities);
    for (int block = 0; block < column_blocks(); ++block) {
        const PathState path = from_above.at(block);
        kernels::begin_path(config.disparities, path.costs, path.least);
    }
}

void SemiGlobalSearch::Workspace::take_census(int strip) {
    for (int v = strip * kLanes; v < std::min(height, (strip + 1) * kLanes); ++v) {
        left_census.make_row(left, width, v);
        right_census.make_row(right, width, v);
    }
}

/// Census words and grey levels of a strip, the rows in the lanes.
void SemiGlobalSearch::Workspace::turn_strip(int strip) {
    const Strip& s = strips[strip % strips_at_once];
    const int v = strip * kLanes;
    const int front = right_census.front;
    const auto turn = [&](const std::uint8_t* rows, std::ptrdiff_t stride, std::uint8_t* out) {
        kernels::transpose(rows, stride, out, kernels::kCensusRow);
    };
    for (int u = 0; u < padded(width); u += kLanes) {
        kernels::transpose(left.row(v) + u, left.stride, s.grey.data() + u * kLanes, kLanes);
        for (int byte = 0; byte < kCensusBytes; ++byte) {
            turn(left_census.row(byte, v) + u,
                 left_census.stride,
                 s.left.data() + u * kernels::kCensusRow + byte * kLanes);
        }
    }
    for (int u = -front; u < padded(width); u += kLanes) {
        for (int byte = 0; byte < kCensusBytes; ++byte) {
            turn(right_census.row(byte, v) + u,
                 right_census.stride,
                 s.right.data() + (u + front) * kernels::kCensusRow + byte * kLanes);
        }
    }
}

kernels::RowBlock SemiGlobalSearch::Workspace::row_block(int strip, int block) const {
    const Strip& s = strips[strip % strips_at_once];
    const int u = block * kLanes;
    kernels::RowBlock rows;
    rows.left = s.left.data() + u * kernels::kCensusRow;
    rows.right = s.right.data() + (u + right_census.front) * kernels::kCensusRow;
    rows.grey = s.grey.data() + u * kLanes;
    rows.columns = std::min(kLanes, width - u);
    rows.disparities = config.disparities;
    rows.penalties = penalties;
    return rows;
}

/// Follows the paths from the left once to note how they enter each block: their costs of a whole
/// strip would not fit into a cache.
void SemiGlobalSearch::Workspace::pass_strip(int strip) {
    take_census(strip);
    turn_strip(strip);
    const Strip& s = strips[strip % strips_at_once];
    const PathState start = s.from_left.at(0);
    kernels::begin_path(config.disparities, start.costs, start.least);
    for (int block = 0; block < column_blocks(); ++block) {
        s.from_left.copy(block, block + 1);
        if (block + 1 == column_blocks()) break;
        kernels::RowBlock rows = row_block(strip, block);
        rows.grey_before = rows.grey - (block > 0 ? kLanes : 0);
        const PathState path = s.from_left.at(block + 1);
        rows.state = path.costs;
        rows.least = path.least;
        kernels::pass_right(rows);
    }
    const PathState end = s.from_right.at(0);
    kernels::begin_path(config.disparities, end.costs, end.least);
}

/// All three paths and the winners of 64 x 64 pixels. Needs the block to the right of it and the
/// one above.
void SemiGlobalSearch::Workspace::follow_block(int strip, int block, Winners& out) {
    const Strip& s = strips[strip % strips_at_once];
    std::uint8_t* const sums = pool.take();
    kernels::RowBlock rows = row_block(strip, block);
    rows.sums = sums + kernels::kSumsGroup;
    rows.match = rows.sums + sums_size;
    rows.grey_before = rows.grey - (block > 0 ? kLanes : 0);
    const PathState from_left = s.from_left.at(block);
    rows.state = from_left.costs;
    rows.least = from_left.least;
    kernels::follow_right(rows);
    const bool at_edge = block + 1 == column_blocks();
    rows.grey_before = rows.grey + (at_edge ? rows.columns - 1 : kLanes) * kLanes;
    const PathState from_right = s.from_right.at(0);
    rows.state = from_right.costs;
    rows.least = from_right.least;
    kernels::follow_left(rows);
    follow_columns(strip, block, sums, out);
    pool.give_back(sums);
}

/// Calls what one row of a block reads and writes: rows lie too far apart for a processor to guess
/// the next one.
void SemiGlobalSearch::Workspace::call_row(int u, int v, Winners& out) const {
    hwy::Prefetch(left.row(v) + u);
    for (int byte = 0; byte < kCensusBytes; ++byte) {
        hwy::Prefetch(left_census.row(byte, v) + u);
        for (int d = 0; d <= config.disparities; d += kLanes)
            hwy::Prefetch(right_census.row(byte, v) + u - d);
    }
    const auto [disparity, cost, cost_below, cost_above, second_cost] = winners_at(out, u, v);
    const int last = std::min(kLanes, width - u) - 1;
    for (std::uint8_t* const row : {disparity, cost, cost_below, cost_above, second_cost}) {
        hwy::Prefetch(row);
        hwy::Prefetch(row + last);
    }
}

/// Path from above and winners of a block.
void SemiGlobalSearch::Workspace::follow_columns(int strip,
                                                 int block,
                                                 const std::uint8_t* sums,
                                                 Winners& out) {
    const int u = block * kLanes;
    const PathState path = from_above.at(block);
    kernels::ColumnStep step;
    step.state = path.costs;
    step.least = path.least;
    step.disparities = config.disparities;
    step.penalties = penalties;
    const int count = std::min(kLanes, width - u);
    const int end = std::min(height, (strip + 1) * kLanes);
    for (int v = strip * kLanes; v < end; ++v) {
        call_row(u, std::min(v + 1, end - 1), out);
        for (int byte = 0; byte < kCensusBytes; ++byte) {
            step.left[byte] = left_census.row(byte, v) + u;
            step.right[byte] = right_census.row(byte, v) + u;
        }
        step.grey = left.row(v) + u;
        step.grey_above = left.row(std::max(v - 1, 0)) + u;
        step.sums = sums + (v - strip * kLanes) * kernels::kSumsColumn;
        step.match = step.sums + sums_size;
        follow_row(step, winners_at(out, u, v), count);
    }
}

SemiGlobalSearch::SemiGlobalSearch(const SemiGlobalConfig& config)
    : workspace_(std::make_unique<Workspace>()) {
    SUREFOOT_ASSERT(!config.problem());
    workspace_->config = config;
    workspace_->penalties = {static_cast<std::uint8_t>(config.slope_penalty),
                             static_cast<std::uint8_t>(config.jump_penalty),
                             static_cast<std::uint8_t>(config.min_jump_penalty),
                             config.contrast_shift};
}
SemiGlobalSearch::~SemiGlobalSearch() = default;
SemiGlobalSearch::SemiGlobalSearch(SemiGlobalSearch&&) noexcept = default;
SemiGlobalSearch& SemiGlobalSearch::operator=(SemiGlobalSearch&&) noexcept = default;

void SemiGlobalSearch::search(ImageView<const std::uint8_t> left,
                              ImageView<const std::uint8_t> right,
                              Executor& executor,
                              Winners& out) {
    SUREFOOT_ASSERT(left.width == right.width && left.height == right.height && !left.empty());
    Workspace& work = *workspace_;
    work.width = left.width;
    work.height = left.height;
    const int strips = padded(work.height) / kLanes;
    work.strips_at_once = std::clamp(executor.threads(), 1, std::min(strips, kMaxStrips));
    work.left.copy(left);
    work.right.copy(right);
    work.resize();
    out.resize(left.width, left.height);
    const int blocks = work.column_blocks();
    for (int first = 0; first < strips; first += work.strips_at_once) {
        const int count = std::min(work.strips_at_once, strips - first);
        executor.parallel_for(count, [&](int k) { work.pass_strip(first + k); });
        // From the right to the left, every strip one block behind the one above it.
        for (int wave = 0; wave < blocks + count - 1; ++wave) {
            executor.parallel_for(count, [&](int k) {
                const int block = blocks - 1 - (wave - k);
                if (block >= 0 && block < blocks) work.follow_block(first + k, block, out);
            });
        }
    }
}

}  // namespace surefoot::stereo
