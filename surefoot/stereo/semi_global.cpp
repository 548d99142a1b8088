// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/semi_global.hpp"

#include <algorithm>
#include <cstring>
#include <new>
#include <utility>

#include "surefoot/core/assert.hpp"
#include "surefoot/stereo/row_blocks.hpp"
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

/// What 64 rows need, column by column with the rows in the lanes.
struct Strip {
    AlignedBytes left;
    AlignedBytes right;
    AlignedBytes grey;
    AlignedBytes sums;
    AlignedBytes state;
};

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
    Strip strips[2];  ///< of this and of the next 64 rows
    std::ptrdiff_t sums_stride = 0;
    AlignedBytes above;  ///< per 64 columns: path from above
    AlignedBytes least;  ///< and its least cost

    [[nodiscard]] int column_blocks() const { return padded(width) / kLanes; }
    [[nodiscard]] std::ptrdiff_t states() const {
        return static_cast<std::ptrdiff_t>(config.disparities + 1) * kLanes;
    }

    void resize();
    void take_census(Executor& executor);
    void follow_strip(int strip);
    void follow_block(int strip, int block, Winners& out);
};

void SemiGlobalSearch::Workspace::resize() {
    left_census.resize(width, height, 0);
    right_census.resize(width, height, config.disparities);
    // One more row than needed: places 4 KiB apart would share their lines of the cache.
    sums_stride = static_cast<std::ptrdiff_t>(config.disparities) * kLanes + kLanes;
    const auto columns = static_cast<std::size_t>(padded(width));
    const auto front = static_cast<std::size_t>(padded(config.disparities));
    const auto stride = static_cast<std::size_t>(sums_stride);
    for (Strip& strip : strips) {
        strip.left.resize(columns * kernels::kCensusRow);
        strip.right.resize((columns + front) * kernels::kCensusRow);
        strip.grey.resize(columns * kLanes);
        strip.sums.resize(columns * stride);
        strip.state.resize(static_cast<std::size_t>(states()));
    }
    const auto blocks = static_cast<std::size_t>(column_blocks());
    above.resize(blocks * static_cast<std::size_t>(states()));
    least.resize(blocks * kLanes);
    // The path from above begins with nothing; beyond the last disparity nothing is worse.
    std::memset(least.data(), 0, blocks * kLanes);
    for (int block = 0; block < column_blocks(); ++block) {
        std::uint8_t* const state = above.data() + block * states();
        std::memset(state, 0, static_cast<std::size_t>(states() - kLanes));
        std::memset(state + states() - kLanes, 255, kLanes);
    }
}

void SemiGlobalSearch::Workspace::take_census(Executor& executor) {
    for_row_blocks(executor, height, [&](int first, int last) {
        for (int v = first; v < last; ++v) {
            left_census.make_row(left, width, v);
            right_census.make_row(right, width, v);
        }
    });
}

/// Paths along the rows of a strip.
void SemiGlobalSearch::Workspace::follow_strip(int strip) {
    const Strip& s = strips[strip % 2];
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
    kernels::RowStrip rows;
    rows.left = s.left.data();
    rows.right = s.right.data() + front * kernels::kCensusRow;
    rows.grey = s.grey.data();
    rows.sums = s.sums.data();
    rows.sums_stride = sums_stride;
    rows.state = s.state.data();
    rows.width = width;
    rows.disparities = config.disparities;
    rows.penalties = penalties;
    kernels::follow_rows(rows);
}

/// Path from above and winners, 64 columns of a strip.
void SemiGlobalSearch::Workspace::follow_block(int strip, int block, Winners& out) {
    const int u = block * kLanes;
    const std::uint8_t* const sums = strips[strip % 2].sums.data() + u * sums_stride;
    kernels::ColumnStep step;
    step.state = above.data() + block * states();
    step.least = least.data() + block * kLanes;
    step.disparities = config.disparities;
    step.penalties = penalties;
    const auto count = static_cast<std::size_t>(std::min(kLanes, width - u));
    kernels::WinnerRows winners;  // all of it is written. NOLINT(*-member-init)
    for (int v = strip * kLanes; v < std::min(height, (strip + 1) * kLanes); ++v) {
        for (int byte = 0; byte < kCensusBytes; ++byte) {
            step.left[byte] = left_census.row(byte, v) + u;
            step.right[byte] = right_census.row(byte, v) + u;
        }
        step.grey = left.row(v) + u;
        step.grey_above = left.row(std::max(v - 1, 0)) + u;
        step.sums = sums + (v - strip * kLanes) * sums_stride;
        kernels::follow_columns(step, winners);
        std::memcpy(out.disparity.row(v) + u, winners.disparity, count);
        std::memcpy(out.cost.row(v) + u, winners.cost, count);
        std::memcpy(out.cost_below.row(v) + u, winners.cost_below, count);
        std::memcpy(out.cost_above.row(v) + u, winners.cost_above, count);
        std::memcpy(out.second_cost.row(v) + u, winners.second_cost, count);
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
    work.left.copy(left);
    work.right.copy(right);
    work.resize();
    out.resize(left.width, left.height);
    work.take_census(executor);
    // The rows of the next strip beside the columns of this one: neither waits for the other.
    const int strips = padded(work.height) / kLanes;
    work.follow_strip(0);
    for (int strip = 0; strip < strips; ++strip) {
        const int row_tasks = strip + 1 < strips ? 1 : 0;
        executor.parallel_for(row_tasks + work.column_blocks(), [&](int task) {
            if (task < row_tasks)
                work.follow_strip(strip + 1);
            else
                work.follow_block(strip, task - row_tasks, out);
        });
    }
}

}  // namespace surefoot::stereo
