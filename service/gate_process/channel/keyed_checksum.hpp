// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "surefoot/core/result.hpp"

namespace surefoot::gate_process {

/// 128 secret bits that two processes share.
struct ChecksumKey {
    std::uint64_t low = 0;
    std::uint64_t high = 0;
    friend bool operator==(const ChecksumKey&, const ChecksumKey&) = default;
};

/// A new key from the random numbers of the system.
[[nodiscard]] Result<ChecksumKey> new_checksum_key();
/// Reads a key from a file: 32 hexadecimal digits, white space around them. An error names the file
/// and says why: not a regular file, readable by other users, or not 32 digits.
[[nodiscard]] Result<ChecksumKey> read_checksum_key(const std::string& path);
/// The key as 16 bytes, as the processes hand it on.
[[nodiscard]] std::string bytes_of(const ChecksumKey& key);
/// The key of the first 16 of `bytes`. Precondition: there are as many.
[[nodiscard]] ChecksumKey key_of(std::string_view bytes) noexcept;

/// A checksum that nobody can make without the key: SipHash-2-4 (Aumasson, Bernstein: "SipHash: a
/// fast short-input PRF", INDOCRYPT 2012). 64 bits: a forger without the key succeeds once in 2^64
/// attempts. About 1 ms for 3 MB.
class KeyedChecksum {
  public:
    explicit KeyedChecksum(const ChecksumKey& key) noexcept;

    void add(std::uint64_t word) noexcept;
    /// Whole words; what is left of them, up to 7 bytes, must be the end of the message.
    void add(std::span<const unsigned char> bytes) noexcept;
    /// Once, at the end.
    [[nodiscard]] std::uint64_t finish() noexcept;

  private:
    void compress(std::uint64_t word) noexcept;

    std::uint64_t v0_;
    std::uint64_t v1_;
    std::uint64_t v2_;
    std::uint64_t v3_;
    std::uint64_t tail_ = 0;    ///< the bytes of the last, broken word
    std::uint64_t length_ = 0;  ///< bytes so far
};

}  // namespace surefoot::gate_process
