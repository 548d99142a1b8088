// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>

#include "service/gate_process/channel/keyed_checksum.hpp"

namespace surefoot::gate_process {

/// Returns a keyed checksum of a large memory block, several times as fast as KeyedChecksum
/// alone. NH hashes each block of 1024 bytes to 16 bytes with secret 64-bit words (Black,
/// Halevi, Krawczyk, Krovetz, Rogaway: "UMAC: fast and secure message authentication", CRYPTO
/// 1999, section 4). KeyedChecksum then hashes the labels, the length and these hashes. The
/// secret words are never visible. So two different messages of one length collide with a
/// probability of at most 2^-64, for any choice. `labels` identify the memory; their number must
/// be constant.
[[nodiscard]] std::uint64_t memory_checksum(const ChecksumKey& key,
                                            std::initializer_list<std::uint64_t> labels,
                                            std::span<const unsigned char> bytes) noexcept;

}  // namespace surefoot::gate_process
