// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>

#include "service/gate_process/channel/keyed_checksum.hpp"

namespace surefoot::gate_process {

/// A keyed checksum of a large piece of memory, several times as fast as KeyedChecksum alone: each
/// block of 1024 bytes is hashed to 16 bytes with secret numbers (NH with words of 64 bits: Black,
/// Halevi, Krawczyk, Krovetz, Rogaway: "UMAC: fast and secure message authentication", CRYPTO 1999,
/// section 4), and KeyedChecksum takes the labels, the length and these hashes. Two different
/// messages of one length have the same hashes with a probability of at most 2^-64, whoever chose
/// them, because the secret numbers never show. `labels`: what the memory belongs to; always as
/// many.
[[nodiscard]] std::uint64_t memory_checksum(const ChecksumKey& key,
                                            std::initializer_list<std::uint64_t> labels,
                                            std::span<const unsigned char> bytes) noexcept;

}  // namespace surefoot::gate_process
