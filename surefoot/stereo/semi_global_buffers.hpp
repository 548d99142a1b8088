// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>

#include "surefoot/core/views.hpp"
#include "surefoot/stereo/semi_global_simd.hpp"

/// Memory of SemiGlobalSearch. Buffers grow and never shrink.
namespace surefoot::stereo {

using kernels::kLanes;

/// Smallest multiple of kLanes that is not below `count`.
constexpr int padded(int count) {
    return (count + kLanes - 1) / kLanes * kLanes;
}

/// Bytes at addresses aligned for whole registers.
class AlignedBytes {
  public:
    AlignedBytes() = default;
    AlignedBytes(const AlignedBytes&) = delete;
    AlignedBytes& operator=(const AlignedBytes&) = delete;
    ~AlignedBytes() { release(); }

    /// New memory holds zeros.
    void resize(std::size_t size) {
        if (size > size_) {
            resize_untouched(size);
            std::memset(bytes_, 0, size);
        }
    }
    /// New memory holds anything. Pages that nobody writes take no memory.
    void resize_untouched(std::size_t size) {
        if (size <= size_) return;
        release();
        bytes_ = static_cast<std::uint8_t*>(::operator new(size, kAlignment));
        size_ = size;
    }
    [[nodiscard]] std::uint8_t* data() const noexcept { return bytes_; }

  private:
    static constexpr std::align_val_t kAlignment{kLanes};
    void release() {
        if (bytes_ != nullptr) ::operator delete(bytes_, kAlignment);
        bytes_ = nullptr;
        size_ = 0;
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
        std::uint8_t* const rows[kCensusBytes] = {row(0, v), row(1, v)};
        kernels::census(image.row(v), image.stride, padded(width), rows);
        for (std::uint8_t* const out : rows)
            std::memset(out - front, out[0], static_cast<std::size_t>(front));
    }
};

/// State of a path at one column or row: costs per disparity, one extra entry, and the least cost.
struct PathState {
    std::uint8_t* costs = nullptr;
    std::uint8_t* least = nullptr;
};

/// States of many paths, or of one path at many places.
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

}  // namespace surefoot::stereo
