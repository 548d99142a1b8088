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

/// Makes a key from random numbers of the operating system.
[[nodiscard]] Result<ChecksumKey> new_checksum_key();
/// Reads a key file: 32 hexadecimal digits, optionally followed by white space. An error names the
/// file and the cause: not regular, not readable, open to other users, not 32 digits.
[[nodiscard]] Result<ChecksumKey> read_checksum_key(const std::string& path);
/// Returns the key as 16 bytes, so that one process can pass it to another.
[[nodiscard]] std::string bytes_of(const ChecksumKey& key);
/// Makes a key from the first 16 of `bytes`. Precondition: `bytes` has at least 16 bytes.
[[nodiscard]] ChecksumKey key_of(std::string_view bytes) noexcept;

/// A checksum that cannot be forged without the key: SipHash-2-4 (Aumasson, Bernstein: "SipHash: a
/// fast short-input PRF", INDOCRYPT 2012). It has 64 bits: an attempt without the key succeeds with
/// probability 2^-64. Takes about 1 ms for 3 MB.
class KeyedChecksum {
  public:
    explicit KeyedChecksum(const ChecksumKey& key) noexcept;

    void add(std::uint64_t word) noexcept;
    /// Adds whole words of 8 bytes. Only the last call may end with 1 to 7 bytes more.
    void add(std::span<const unsigned char> bytes) noexcept;
    /// Returns the checksum. Call it once, at the end.
    [[nodiscard]] std::uint64_t finish() noexcept;

  private:
    void compress(std::uint64_t word) noexcept;

    std::uint64_t v0_;
    std::uint64_t v1_;
    std::uint64_t v2_;
    std::uint64_t v3_;
    std::uint64_t tail_ = 0;    ///< the bytes of the last, incomplete word
    std::uint64_t length_ = 0;  ///< number of bytes so far
};

}  // namespace surefoot::gate_process
