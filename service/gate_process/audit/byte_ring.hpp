// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

namespace surefoot::gate_process {

/// A queue of entries of any length between two threads, without lock or allocation. An entry
/// without room is rejected. The writing thread calls `reserve`, `commit` and `oldest`; the reading
/// thread calls `front` and `pop`.
class ByteRing {
  public:
    /// Allocates and touches all memory. An empty ring accepts each entry of up to half of it.
    explicit ByteRing(std::size_t bytes);

    /// Returns memory for an entry of `bytes` bytes; nullptr if there is no room.
    [[nodiscard]] char* reserve(std::size_t bytes) noexcept;
    /// Publishes the entry that was reserved last.
    void commit() noexcept;
    /// Returns the oldest entry to the writing thread, or an empty entry if none waits. The reader
    /// may be reading it, and only the next `reserve` may overwrite it.
    [[nodiscard]] std::string_view oldest() const noexcept;

    /// Returns the oldest entry to the reading thread; empty if no entry waits.
    [[nodiscard]] std::string_view front() const noexcept;
    void pop() noexcept;

  private:
    /// Layout of an entry: length and bytes, rounded up to 8 bytes. Positions only increase.
    struct Place {
        std::uint64_t position = 0;
        std::uint64_t length = 0;
    };
    [[nodiscard]] Place place_at(std::uint64_t position) const noexcept;
    [[nodiscard]] std::string_view entry_between(std::uint64_t read,
                                                 std::uint64_t write) const noexcept;

    std::uint64_t capacity_;
    std::unique_ptr<char[]> bytes_;
    std::uint64_t reserved_end_ = 0;
    std::atomic<std::uint64_t> write_{0};
    std::atomic<std::uint64_t> read_{0};
};

}  // namespace surefoot::gate_process
