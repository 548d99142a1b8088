// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/audit/byte_ring.hpp"

#include <cstring>
#include <limits>

namespace surefoot::gate_process {
namespace {

constexpr std::uint64_t kLengthBytes = 8;
/// Stored instead of a length. It means: skip the rest of the memory; the entry is at the start.
constexpr std::uint64_t kSkip = std::numeric_limits<std::uint64_t>::max();

constexpr std::uint64_t rounded_up(std::uint64_t bytes) noexcept {
    return (bytes + 7U) / 8U * 8U;
}

}  // namespace

ByteRing::ByteRing(std::size_t bytes)
    : capacity_(rounded_up(bytes)), bytes_(std::make_unique<char[]>(capacity_)) {}

char* ByteRing::reserve(std::size_t bytes) noexcept {
    const std::uint64_t need = kLengthBytes + rounded_up(bytes);
    const std::uint64_t write = write_.load(std::memory_order_relaxed);
    const std::uint64_t used = write - read_.load(std::memory_order_acquire);
    const std::uint64_t to_end = capacity_ - write % capacity_;
    const std::uint64_t skipped = to_end < need ? to_end : 0;
    if (need > capacity_ || skipped + need > capacity_ - used) return nullptr;
    if (skipped > 0) std::memcpy(&bytes_[write % capacity_], &kSkip, kLengthBytes);
    const std::uint64_t start = (write + skipped) % capacity_;
    const std::uint64_t length = bytes;
    std::memcpy(&bytes_[start], &length, kLengthBytes);
    reserved_end_ = write + skipped + need;
    return &bytes_[start + kLengthBytes];
}

void ByteRing::commit() noexcept {
    write_.store(reserved_end_, std::memory_order_release);
}

ByteRing::Place ByteRing::place_at(std::uint64_t position) const noexcept {
    std::uint64_t length = 0;
    std::memcpy(&length, &bytes_[position % capacity_], kLengthBytes);
    if (length != kSkip) return {position, length};
    position += capacity_ - position % capacity_;
    std::memcpy(&length, &bytes_[0], kLengthBytes);
    return {position, length};
}

std::string_view ByteRing::entry_between(std::uint64_t read, std::uint64_t write) const noexcept {
    if (read == write) return {};
    const Place place = place_at(read);
    return {&bytes_[place.position % capacity_ + kLengthBytes], place.length};
}

std::string_view ByteRing::oldest() const noexcept {
    return entry_between(read_.load(std::memory_order_acquire),
                         write_.load(std::memory_order_relaxed));
}

std::string_view ByteRing::front() const noexcept {
    return entry_between(read_.load(std::memory_order_relaxed),
                         write_.load(std::memory_order_acquire));
}

void ByteRing::pop() noexcept {
    const Place place = place_at(read_.load(std::memory_order_relaxed));
    read_.store(place.position + kLengthBytes + rounded_up(place.length),
                std::memory_order_release);
}

}  // namespace surefoot::gate_process
