// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/channel/memory_checksum.hpp"

#include <array>
#include <cstddef>
#include <cstring>

namespace surefoot::gate_process {
namespace {

__extension__ using Wide = unsigned __int128;

constexpr std::size_t kWord = sizeof(std::uint64_t);
constexpr std::size_t kBlockWords = 128;
constexpr std::size_t kBlockBytes = kBlockWords * kWord;
using BlockKey = std::array<std::uint64_t, kBlockWords>;

/// Use of the key. A message of one use is never valid for another use.
enum class Use : std::uint64_t { block_key = 101, memory = 102 };

/// The secret numbers. KeyedChecksum in counter mode generates them.
BlockKey block_key(const ChecksumKey& key) noexcept {
    BlockKey numbers;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        KeyedChecksum next(key);
        next.add(static_cast<std::uint64_t>(Use::block_key));
        next.add(i);
        numbers[i] = next.finish();
    }
    return numbers;
}

std::uint64_t word_at(const unsigned char* bytes) noexcept {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes, kWord);
    return word;
}

/// Returns NH of one block: the sum of (m[2i] + k[2i]) (m[2i+1] + k[2i+1]) modulo 2^128. The sums
/// in brackets are modulo 2^64.
Wide hash_block(const unsigned char* block, const BlockKey& key) noexcept {
    Wide sum = 0;
    for (std::size_t i = 0; i < kBlockWords; i += 2) {
        const std::uint64_t first = word_at(block + i * kWord) + key[i];
        const std::uint64_t second = word_at(block + (i + 1) * kWord) + key[i + 1];
        sum += static_cast<Wide>(first) * second;
    }
    return sum;
}

}  // namespace

std::uint64_t memory_checksum(const ChecksumKey& key,
                              std::initializer_list<std::uint64_t> labels,
                              std::span<const unsigned char> bytes) noexcept {
    const BlockKey numbers = block_key(key);
    KeyedChecksum checksum(key);
    checksum.add(static_cast<std::uint64_t>(Use::memory));
    for (const std::uint64_t label : labels) checksum.add(label);
    checksum.add(bytes.size());
    const auto add_block = [&](const unsigned char* block) {
        const Wide hash = hash_block(block, numbers);
        checksum.add(static_cast<std::uint64_t>(hash));
        checksum.add(static_cast<std::uint64_t>(hash >> 64U));
    };
    for (; bytes.size() >= kBlockBytes; bytes = bytes.subspan(kBlockBytes)) add_block(bytes.data());
    if (!bytes.empty()) {
        std::array<unsigned char, kBlockBytes> last{};
        std::memcpy(last.data(), bytes.data(), bytes.size());
        add_block(last.data());
    }
    return checksum.finish();
}

}  // namespace surefoot::gate_process
