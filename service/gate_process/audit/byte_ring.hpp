// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

namespace surefoot::gate_process {

/// Entries of any length from one thread to one other, without a lock and without allocating: what
/// has no room is refused. The writing thread calls `reserve`, `commit` and `oldest`, the reading
/// one `front` and `pop`.
class ByteRing {
  public:
    /// All memory is taken, and touched, here. Room for entries of up to half of it.
    explicit ByteRing(std::size_t bytes);

    /// Where an entry of `bytes` bytes may be written; nullptr when there is no room.
    [[nodiscard]] char* reserve(std::size_t bytes) noexcept;
    /// Hands over the entry that was reserved last.
    void commit() noexcept;
    /// The entry that waits longest, as the writing thread sees it: perhaps it is being read, and
    /// only the next `reserve` may overwrite it. Empty when none waits.
    [[nodiscard]] std::string_view oldest() const noexcept;

    /// The entry that waits longest; empty when none does.
    [[nodiscard]] std::string_view front() const noexcept;
    void pop() noexcept;

  private:
    /// Each entry is its length and its bytes, rounded up to 8; positions only grow.
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
