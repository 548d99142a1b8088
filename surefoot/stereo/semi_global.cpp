// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/semi_global.hpp"

#include <hwy/cache_control.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <utility>
#include <vector>

#include "surefoot/core/assert.hpp"
#include "surefoot/stereo/semi_global_simd.hpp"

namespace surefoot::stereo {
namespace {

using kernels::kLanes;

constexpr int padded(int count) {
    return (count + kLanes - 1) / kLanes * kLanes;
}

/// Bytes at addresses aligned for whole registers. The buffer grows and never shrinks.
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

/// An image with a border that repeats the edge of the image. Rows are aligned.
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

/// Census words of an image: one plane for each byte, row by row. `front` columns before a row
/// repeat its first column.
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

/// State of a path at one column or row: costs per disparity, one extra entry (255), and the least
/// cost.
struct PathState {
    std::uint8_t* costs = nullptr;
    std::uint8_t* least = nullptr;
};

/// Path states at many columns.
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

/// Data of 64 rows during their search, column by column with the rows in the lanes.
struct Strip {
    int index = 0;  ///< number of the strip in the image
    AlignedBytes left;
    AlignedBytes right;
    AlignedBytes grey;
    PathStates from_left;  ///< state at the start of each block of 64 columns
    PathStates from_right;
    AlignedBytes sums;  ///< sums of one block, then matching costs; a free group before each part
};

/// Number of finished blocks of 64 columns of each strip. A thread that has finished a strip begins
/// the next strip, upper strips first, and follows the strip above block by block. So a thread
/// only waits for work that already runs. On an executor with one thread, tasks that wait for tasks
/// not yet begun would wait forever.
class Progress {
  public:
    void begin(int strips) {
        if (strips > capacity_) {
            done_ = std::make_unique<std::atomic<int>[]>(static_cast<std::size_t>(strips));
            capacity_ = strips;
        }
        for (int strip = 0; strip < strips; ++strip) at(strip).store(0, std::memory_order_relaxed);
        next_.store(0, std::memory_order_relaxed);
    }
    /// Returns the next strip that is not begun yet. The number may lie beyond the last strip.
    [[nodiscard]] int take_strip() { return next_.fetch_add(1, std::memory_order_relaxed); }
    void block_is_done(int strip) {
        at(strip).fetch_add(1, std::memory_order_release);
        at(strip).notify_all();
    }
    void wait_for(int strip, int blocks) {
        std::atomic<int>& done = at(strip);
        for (int seen = done.load(std::memory_order_acquire); seen < blocks;
             seen = done.load(std::memory_order_acquire))
            done.wait(seen, std::memory_order_acquire);
    }

  private:
    [[nodiscard]] std::atomic<int>& at(int strip) { return done_[static_cast<std::size_t>(strip)]; }
    std::unique_ptr<std::atomic<int>[]> done_;  // NOLINT(*-avoid-c-arrays): size known at run time
    int capacity_ = 0;
    std::atomic<int> next_ = 0;
};

/// Largest number of strips that are processed at the same time, one per thread. The data of a
/// strip stay in the cache until they are used.
constexpr int kMaxStrips = 6;

kernels::WinnerRows winners_at(Winners& out, int u, int v) {
    return {out.disparity.row(v) + u,
            out.cost.row(v) + u,
            out.cost_below.row(v) + u,
            out.cost_above.row(v) + u,
            out.second_cost.row(v) + u};
}

/// Processes one row of a block, of which `count` columns lie in the image.
void follow_row(const kernels::ColumnStep& step, const kernels::WinnerRows& out, int count) {
    if (count == kLanes) return kernels::follow_columns(step, out);
    std::uint8_t rows[5][kLanes];  // follow_columns writes every element. NOLINT(*-member-init)
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
    Strip strips[kMaxStrips];  ///< one for each thread that works at the same time
    std::ptrdiff_t sums_size = 0;
    Progress progress;
    PathStates from_above;  ///< one state per 64 columns

    [[nodiscard]] int column_blocks() const { return padded(width) / kLanes; }

    void resize(int strips_at_once);
    void take_census(int strip);
    void turn_strip(const Strip& s);
    void pass_strip(const Strip& s);
    void follow_rows(const Strip& s, int block);
    void follow_columns(const Strip& s, int block, Winners& out);
    void follow_strip(const Strip& s, Winners& out);
    void call_row(int u, int v, Winners& out) const;
    [[nodiscard]] kernels::RowBlock row_block(const Strip& s, int block) const;
};

void SemiGlobalSearch::Workspace::resize(int strips_at_once) {
    left_census.resize(width, height, 0);
    right_census.resize(width, height, config.disparities);
    const int groups = (config.disparities + kernels::kGroup - 1) / kernels::kGroup;
    sums_size = static_cast<std::ptrdiff_t>(groups + 1) * kernels::kSumsGroup;
    const auto columns = static_cast<std::size_t>(padded(width));
    const auto front = static_cast<std::size_t>(padded(config.disparities));
    for (Strip& strip : std::span(strips).first(static_cast<std::size_t>(strips_at_once))) {
        strip.left.resize(columns * kernels::kCensusRow);
        strip.right.resize((columns + front) * kernels::kCensusRow);
        strip.grey.resize(columns * kLanes);
        strip.from_left.resize(column_blocks() + 1, config.disparities);
        strip.from_right.resize(1, config.disparities);
        strip.sums.resize(static_cast<std::size_t>(2 * sums_size));
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

/// Transposes census words and grey levels of a strip, so that rows lie in the lanes.
void SemiGlobalSearch::Workspace::turn_strip(const Strip& s) {
    const int v = s.index * kLanes;
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

kernels::RowBlock SemiGlobalSearch::Workspace::row_block(const Strip& s, int block) const {
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

/// Runs the paths from the left once and stores only their state at each block. The costs of a
/// whole strip would not fit into a cache.
void SemiGlobalSearch::Workspace::pass_strip(const Strip& s) {
    take_census(s.index);
    turn_strip(s);
    const PathState start = s.from_left.at(0);
    kernels::begin_path(config.disparities, start.costs, start.least);
    for (int block = 0; block < column_blocks(); ++block) {
        s.from_left.copy(block, block + 1);
        if (block + 1 == column_blocks()) break;
        kernels::RowBlock rows = row_block(s, block);
        rows.grey_before = rows.grey - (block > 0 ? kLanes : 0);
        const PathState path = s.from_left.at(block + 1);
        rows.state = path.costs;
        rows.least = path.least;
        kernels::pass_right(rows);
    }
    const PathState end = s.from_right.at(0);
    kernels::begin_path(config.disparities, end.costs, end.least);
}

/// Runs both paths along the rows through 64 x 64 pixels. Needs the result of the block to the
/// right.
void SemiGlobalSearch::Workspace::follow_rows(const Strip& s, int block) {
    kernels::RowBlock rows = row_block(s, block);
    rows.sums = s.sums.data() + kernels::kSumsGroup;
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
}

/// Prefetches the data that one row of a block reads and writes. Rows lie too far apart for the
/// processor to predict the next row.
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

/// Runs the path from above through a block and finds the winners. Needs the result of the block
/// above, and the row paths of this block.
void SemiGlobalSearch::Workspace::follow_columns(const Strip& s, int block, Winners& out) {
    const int u = block * kLanes;
    const PathState path = from_above.at(block);
    kernels::ColumnStep step;
    step.state = path.costs;
    step.least = path.least;
    step.disparities = config.disparities;
    step.penalties = penalties;
    const int count = std::min(kLanes, width - u);
    const int begin = s.index * kLanes;
    const int end = std::min(height, begin + kLanes);
    for (int v = begin; v < end; ++v) {
        call_row(u, std::min(v + 1, end - 1), out);
        for (int byte = 0; byte < kCensusBytes; ++byte) {
            step.left[byte] = left_census.row(byte, v) + u;
            step.right[byte] = right_census.row(byte, v) + u;
        }
        step.grey = left.row(v) + u;
        step.grey_above = left.row(std::max(v - 1, 0)) + u;
        step.sums = s.sums.data() + (v - begin) * kernels::kSumsColumn;
        step.match = step.sums + sums_size;
        follow_row(step, winners_at(out, u, v), count);
    }
}

/// Processes blocks from right to left, directly behind the strip above.
void SemiGlobalSearch::Workspace::follow_strip(const Strip& s, Winners& out) {
    const int blocks = column_blocks();
    for (int done = 0; done < blocks; ++done) {
        const int block = blocks - 1 - done;
        follow_rows(s, block);
        if (s.index > 0) progress.wait_for(s.index - 1, done + 1);
        follow_columns(s, block, out);
        progress.block_is_done(s.index);
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
    const int at_once = std::clamp(executor.threads(), 1, std::min(strips, kMaxStrips));
    work.left.copy(left);
    work.right.copy(right);
    work.resize(at_once);
    work.progress.begin(strips);
    out.resize(left.width, left.height);
    executor.parallel_for(at_once, [&](int k) {
        Strip& strip = work.strips[k];
        for (;;) {
            strip.index = work.progress.take_strip();
            if (strip.index >= strips) return;
            work.pass_strip(strip);
            work.follow_strip(strip, out);
        }
    });
}

}  // namespace surefoot::stereo
